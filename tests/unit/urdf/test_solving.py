"""URDF systems through the whole engine: converged, certified, contacts and norms in place."""

import math
from typing import Any

import numpy as np
import pytest

from footfall.curves import Curve
from schemas.expressions import derivative
from schemas.reading import read_problem
from schemas.results import Solution, SolutionStatus
from solver import solve
from tests.support.robots import joint, robot


def rod(name: str, mass: float, down: float) -> str:
    return (
        f'<link name="{name}"><inertial><origin xyz="0 0 {-down / 2}"/><mass value="{mass}"/>'
        '<inertia ixx="0.02" iyy="0.02" izz="0.01"/></inertial></link>'
    )


HIP, KNEE = "0.7", "-1.4"
HOPPER = robot(
    rod("trunk", 5, 0),
    rod("thigh", 0.5, 0.3),
    rod("shank", 0.3, 0.3),
    joint("hip", "revolute", "trunk", "thigh", '<axis xyz="0 1 0"/>'),
    joint("knee", "revolute", "thigh", "shank", '<origin xyz="0 0 -0.3"/><axis xyz="0 1 0"/>'),
)
START = {"base.x": 0, "base.z": f"0.6*cos({HIP})", "base.pitch": 0, "hip": HIP, "knee": KNEE}
BALANCED = "contact.foot.tangential_x^2 - 0.5*contact.foot.normal^2"


def squat(method: dict[str, Any]) -> dict[str, Any]:
    """A leg under a trunk goes down and comes to rest; the foot stays, by friction."""
    names = ["base.x", "base.z", "base.pitch", "hip", "knee"]
    rest = {derivative(name): 0 for name in names}
    return {
        "name": "squat",
        "phases": [
            {
                "name": "stance",
                "system": {
                    "kind": "urdf",
                    "text": HOPPER,
                    "base": "planar",
                    "contacts": {"foot": {"link": "shank", "at": [0, 0, -0.3]}},
                    "mode": {"foot": "sticking_x"},
                    "motors": ["hip", "knee"],
                },
                "time": {"final": 0.6},
                "initial": {**START, **rest},
                "final": {"base.z": 0.4, "d(hip)": 0, "d(knee)": 0, "base.d(pitch)": 0},
                "path": [
                    {"name": "press", "expression": "contact.foot.normal", "lower": 0},
                    {"name": "cone", "expression": BALANCED, "upper": 0},
                ],
                "integrals": {"effort": "motor.hip.torque^2 + motor.knee.torque^2"},
            }
        ],
        "objective": {"minimize": "effort"},
        "method": method,
        "refinement": {"tolerance": 1e-5},
    }


def series(solution: Solution, name: str) -> Any:
    for group in solution.phases[0].curves.values():
        if name in group.coefficients:
            curve = Curve(group.breaks, np.array(group.coefficients[name], dtype=float))
            return curve(np.asarray(group.breaks))
    raise KeyError(name)


@pytest.mark.parametrize("kind", ["hermite_simpson", "radau"])
def test_a_foot_stays_where_it_is(kind: str) -> None:
    solution = solve(read_problem(squat({"kind": kind, "segments": 10})))
    assert solution.status is SolutionStatus.CONVERGED, solution.message
    assert solution.certificate.verdict == "certified"
    x, z, pitch, hip, knee = (
        series(solution, name) for name in ("base.x", "base.z", "base.pitch", "hip", "knee")
    )
    first, second = pitch + hip, pitch + hip + knee
    assert np.abs(z - 0.3 * np.cos(first) - 0.3 * np.cos(second)).max() < 1e-10
    foot = x - 0.3 * np.sin(first) - 0.3 * np.sin(second)
    assert np.abs(foot - foot[0]).max() < 1e-10


def test_the_norm_of_a_free_base_stays_one() -> None:
    document = squat({"kind": "hermite_simpson", "segments": 10})
    phase = document["phases"][0]
    phase["system"] |= {"base": "floating", "contacts": {}, "mode": {}}
    phase["path"] = []
    turned = {"base.qw": math.cos(0.1), "base.qx": 0, "base.qy": math.sin(0.1), "base.qz": 0}
    free = ["x", "y", "z", "qw", "qx", "qy", "qz"]
    phase["initial"] = {**{f"base.{one}": 0 for one in "xyz"}, **turned, "hip": 0.3, "knee": -0.6}
    phase["initial"] |= {f"base.d({one})": 0 for one in free} | {"d(hip)": 0, "d(knee)": 0}
    phase["final"] = {"base.qy": 0.08, "d(hip)": 0, "d(knee)": 0}
    solution = solve(read_problem(document))
    assert solution.status is SolutionStatus.CONVERGED, solution.message
    assert solution.certificate.verdict == "certified"
    norms = sum(series(solution, f"base.q{one}") ** 2 for one in "wxyz")
    assert np.abs(norms - 1).max() < 1e-10
