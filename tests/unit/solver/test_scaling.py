"""Units do not matter: the same motion in other units takes the same way to the same optimum."""

from typing import Any

import numpy as np
import pytest

import examples
from solver.nlp.scaling import typical_size
from tests.unit.solver.problems import solved


def in_units(position: float, force: float) -> dict[str, Any]:
    """The cart-pole with the cart's position and the force in other units."""
    document = examples.load("cart_pole")
    phase = document["phases"][0]
    system = phase["system"]
    system["define"]["f"] = f"u/{force}"
    for name in ("v1", "v2"):
        text = system["derivatives"][name]
        system["derivatives"][name] = text.replace("+ u ", "+ f ").replace("+ u*", "+ f*")
    system["derivatives"]["q1"] = f"{position}*v1"
    phase["bounds"] = {"q1": [-2 * position, 2 * position], "u": [-20 * force, 20 * force]}
    phase["final"]["q1"] = position
    phase["integrals"] = {"effort": "f^2"}
    return document


@pytest.mark.parametrize(("position", "force"), [(1e3, 1), (1e5, 1e-4), (1e-4, 1e4), (1, 1e7)])
def test_the_optimum_does_not_depend_on_units(position: float, force: float) -> None:
    solution = solved(in_units(position, force))
    assert solution.objective == pytest.approx(58.80767, abs=1e-4)
    assert solution.mesh_refinement.iterations[0].nlp_iterations <= 14


def test_sizes_near_one_are_left_alone() -> None:
    samples = np.array([[0.0, 0.0], [0.02, -0.01], [90.0, np.inf], [3e3, 1.0], [1e-5, 0.0]])
    np.testing.assert_allclose(typical_size(samples), [1, 1, 1, 3e3, 1e-5])
