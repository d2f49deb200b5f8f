"""Costates against Pontryagin's: of the regulator, and of an oscillator brought to rest."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm, solve_continuous_lyapunov

from schemas.reading import read_problem
from solver import solve
from tests.convergence.test_second_order import document as oscillator
from tests.support.methods import label, variants

Array = NDArray[np.float64]
BAND = 0.35
ROUNDING = 1e-8  # what the NLP's tolerance leaves of multipliers


def order(method: dict[str, Any]) -> int:
    """Of the costates: that of the method's own quadrature at the places where it knows them."""
    kind = method["kind"]
    if kind == "radau":
        return int(method["points"])
    return {"chebyshev_lobatto": 3, "multiple_shooting": 4, "dircol5i": 3}.get(kind, 2)


def regulator(method: dict[str, Any], segments: int) -> dict[str, Any]:
    phase = {
        "system": {
            "kind": "ode",
            "states": ["x"],
            "controls": ["u"],
            "derivatives": {"x": "0.5*x + u"},
        },
        "time": {"final": 1},
        "initial": {"x": 1},
        "integrals": {"cost": "0.625*x^2 + 0.5*x*u + 0.5*u^2"},
    }
    return {
        "phases": [phase],
        "objective": {"minimize": "cost"},
        "method": {**method, "segments": segments},
        "refinement": None,
        "solver": {"tolerance": 1e-12},
    }


def errors(documents: list[dict[str, Any]], name: str, exact: Any) -> Array:
    """The largest error of a costate in each document's solution."""
    found = []
    for document in documents:
        group = solve(read_problem(document)).phases[0].groups["costates"]
        values = np.array(group.values[name], dtype=float)
        found.append(np.max(np.abs(values - np.array([exact(t) for t in group.time]))))
    return np.array(found)


def slope(sizes: Array, meshes: Array) -> float:
    usable = np.flatnonzero(sizes > ROUNDING)[-3:]
    assert len(usable) >= 2
    return -float(np.polyfit(np.log(meshes[usable]), np.log(sizes[usable]), 1)[0])


@pytest.mark.parametrize("method", variants(), ids=label)
def test_the_regulator(method: dict[str, Any]) -> None:
    """p = sinh(1 - t) / cosh(1)."""
    meshes = np.array([2, 4, 8, 16, 32])
    sizes = errors(
        [regulator(method, int(n)) for n in meshes],
        "x",
        lambda t: np.sinh(1 - t) / np.cosh(1),
    )
    assert sizes[-1] < 2e-4
    assert abs(slope(sizes, meshes) - order(method)) < BAND


@pytest.mark.parametrize("method", variants(second_order=True), ids=label)
def test_the_velocity_of_an_oscillator(method: dict[str, Any]) -> None:
    """p(0) is the gradient of x0' inv(W) x0, W the Gramian; then p' = -A' p."""
    a, b = np.array([[0.0, 1.0], [-1.0, -0.1]]), np.array([[0.0], [1.0]])
    ahead = expm(-a)
    gramian = solve_continuous_lyapunov(-a, ahead @ b @ b.T @ ahead.T - b @ b.T)
    first = 2 * np.linalg.solve(gramian, np.array([1.0, 0.0]))
    meshes = np.array([2, 4, 8, 16, 32])
    if method["kind"] == "chebyshev_lobatto":
        meshes = meshes[:3]
    sizes = errors(
        [oscillator("explicit", method, int(n)) for n in meshes],
        "d(q)",
        lambda t: (expm(-a.T * t) @ first)[1],
    )
    assert sizes[-1] < 0.05
    if method["kind"] != "chebyshev_lobatto":
        assert abs(slope(sizes, meshes) - order(method)) < BAND
