"""Every method on a second-order system, explicit and implicit, converges with its order.

The least effort that brings an oscillator to rest is known from its controllability Gramian.
"""

from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad_vec
from scipy.linalg import expm

from schemas.reading import read_problem
from solver import solve
from tests.convergence.test_orders import BAND, order_of
from tests.support.methods import label, variants

ROUNDING = 1e-12
FORMS: dict[str, dict[str, Any]] = {
    "explicit": {"accelerations": {"q": "u - q - 0.1*d(q)"}},
    "implicit": {"residual": ["2*dd(q) + 2*q + 0.2*d(q) - 2*u"]},
}


@cache
def optimum() -> float:
    """x0' inv(W) x0 for x0 = (1, 0), carried from rest to rest over one second."""
    a, b = np.array([[0.0, 1.0], [-1.0, -0.1]]), np.array([0.0, 1.0])

    def integrand(t: float) -> NDArray[np.float64]:
        column = expm(-a * t) @ b
        return np.outer(column, column)

    gramian, _ = quad_vec(integrand, 0.0, 1.0, epsabs=1e-15, epsrel=1e-15)
    start = np.array([1.0, 0.0])
    return float(start @ np.linalg.solve(gramian, start))


def document(form: str, method: dict[str, Any], segments: int) -> dict[str, Any]:
    rest = {"d(q)": 0}
    phase = {
        "system": {"kind": "second_order", "coordinates": ["q"], "controls": ["u"], **FORMS[form]},
        "time": {"final": 1},
        "initial": {"q": 1, **rest},
        "final": {"q": 0, **rest},
        "integrals": {"effort": "u^2"},
    }
    return {
        "phases": [phase],
        "objective": {"minimize": "effort"},
        "method": {**method, "segments": segments},
        "refinement": None,
        "solver": {"tolerance": 1e-12},
    }


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("method", variants(second_order=True), ids=label)
def test_a_second_order_system_under_every_method(method: dict[str, Any], form: str) -> None:
    meshes = np.array([4, 8, 16, 32, 64] if order_of(method) else [1, 1])
    solutions = [solve(read_problem(document(form, method, int(n)))) for n in meshes]
    errors = np.array([abs((s.objective or np.nan) - optimum()) / optimum() for s in solutions])
    assert set(solutions[-1].phases[0].groups["states"].values) == {"q", "d(q)"}
    if order_of(method) is None:
        assert errors[-1] < 1e-5
        return
    usable = np.flatnonzero(errors > ROUNDING)[-3:]
    assert len(usable) >= 2
    slope = -np.polyfit(np.log(meshes[usable]), np.log(errors[usable]), 1)[0]
    assert abs(slope - (order_of(method) or 0)) < BAND
