"""Constants to numbers."""

import math

from schemas.reading import read_problem
from schemas.resolve import interval, parameters, scalar
from schemas.values import Bound, Scalar
from tests.support.problems import cart_pole


def test_parameters_build_on_each_other() -> None:
    system = read_problem(cart_pole()).phases[0].system
    assert parameters(system) == {"m1": 1.0, "m2": 0.3, "l": 0.5, "g": 9.81}


def test_scalars_and_intervals() -> None:
    assert scalar(Scalar.read("m*pi"), {"m": 2.0}) == 2 * math.pi
    assert interval(None, {}) == (-math.inf, math.inf)
    assert interval(Bound.read(3), {}) == (3.0, 3.0)
    assert interval(Bound.read([None, "m^2"]), {"m": 2.0}) == (-math.inf, 4.0)
