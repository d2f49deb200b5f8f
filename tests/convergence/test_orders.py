"""Every transcription converges with its nominal order on a smooth problem with a known optimum.

The linear-quadratic regulator's optimum is known in closed form. The slope is fitted on the three
finest meshes whose error is above rounding.
"""

from itertools import pairwise

import numpy as np
import pytest
from pydantic import TypeAdapter

import examples
from schemas.methods import Method
from schemas.reading import read_problem
from solver import solve
from solver.transcriptions import make_transcription
from tests.support.methods import label, variants

OPTIMUM = 0.380797077977881  # x' = x/2 + u, the integral of 5/8 x^2 + 1/2 x u + 1/2 u^2, x0 = T = 1
BAND = 0.2
ROUNDING = 1e-12


def objective(method: dict[str, object], segments: int) -> float:
    document = examples.load("linear_quadratic")
    document |= {
        "method": {**method, "segments": segments},
        "refinement": None,
        "solver": {"tolerance": 1e-12},
    }
    solution = solve(read_problem(document))
    assert solution.objective is not None
    return solution.objective


def order_of(method: dict[str, object]) -> int | None:
    return make_transcription(TypeAdapter(Method).validate_python(method)).order


@pytest.mark.parametrize("method", [m for m in variants() if order_of(m)], ids=label)
def test_objective_converges_with_the_nominal_order(method: dict[str, object]) -> None:
    meshes = np.array([2, 4, 8, 16, 32])
    errors = np.array([abs(objective(method, int(n)) - OPTIMUM) for n in meshes])
    usable = np.flatnonzero(errors > ROUNDING)[-3:]
    slope = -np.polyfit(np.log(meshes[usable]), np.log(errors[usable]), 1)[0]
    assert len(usable) == 3
    assert abs(slope - (order_of(method) or 0)) < BAND


def test_the_global_method_converges_with_the_degree() -> None:
    """Chebyshev-Lobatto on one segment. The defects at both ends keep the objective from the
    exponential rate that the motion itself has."""
    errors = [
        abs(objective({"kind": "chebyshev_lobatto", "degree": degree}, 1) - OPTIMUM)
        for degree in (2, 4, 8, 16)
    ]
    assert errors[-1] < 1e-10
    assert all(later < earlier / 50 for earlier, later in pairwise(errors))
