"""Every transcription converges with its nominal order on a smooth problem with a known optimum.

The linear-quadratic regulator's optimum is known in closed form. The slope is fitted on the three
finest meshes whose error is above rounding.
"""

import numpy as np
import pytest

import examples
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


@pytest.mark.parametrize("method", variants(), ids=label)
def test_objective_converges_with_the_nominal_order(method: dict[str, object]) -> None:
    meshes = np.array([4, 8, 16, 32, 64])
    errors = np.array([abs(objective(method, int(n)) - OPTIMUM) for n in meshes])
    usable = np.flatnonzero(errors > ROUNDING)[-3:]
    slope = -np.polyfit(np.log(meshes[usable]), np.log(errors[usable]), 1)[0]
    problem = read_problem(examples.load("linear_quadratic") | {"method": method})
    assert len(usable) == 3
    assert abs(slope - make_transcription(problem.method).order) < BAND
