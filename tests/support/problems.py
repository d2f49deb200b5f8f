"""Problems for tests, as plain data that each test may change."""

from typing import Any

import pytest

from schemas.errors import BadProblem, Issue
from schemas.reading import read_problem

PHASE = "phases 0"
SYSTEM = "phases 0 system"


def cart_pole() -> dict[str, Any]:
    """The cart-pole swing-up, with a path and a boundary constraint, and a guess by points."""
    return {
        "name": "cart-pole swing-up",
        "phases": [
            {
                "name": "swing_up",
                "system": {
                    "kind": "ode",
                    "parameters": {"m1": 1.0, "m2": 0.3, "l": "m1/2", "g": 9.81},
                    "states": ["q1", "q2", "v1", "v2"],
                    "controls": ["u"],
                    "define": {"s": "sin(q2)", "den": "m1 + m2*s^2"},
                    "derivatives": {
                        "q1": "v1",
                        "q2": "v2",
                        "v1": "(l*m2*s*v2^2 + u + m2*g*cos(q2)*s) / den",
                        "v2": "-(l*m2*cos(q2)*s*v2^2 + u*cos(q2) + (m1 + m2)*g*s) / (l*den)",
                    },
                },
                "time": {"initial": 0, "final": [0.1, 10]},
                "bounds": {"q1": [-2, "2*m1"], "u": [-20, 20]},
                "initial": {"q1": 0, "q2": 0, "v1": 0, "v2": 0},
                "final": {"q1": 1, "q2": "pi", "v1": 0, "v2": [None, 0]},
                "path": [{"name": "height", "expression": "q1 + l*cos(q2)", "upper": "4*l"}],
                "boundary": [{"name": "span", "expression": "final.q1 - initial.q1", "lower": 0}],
                "integrals": {"effort": "u^2"},
            }
        ],
        "objective": {"minimize": "effort + 0*duration + 0*swing_up.final.q1"},
        "method": {"kind": "hermite_simpson", "segments": 25},
        "refinement": {"tolerance": 1e-6, "max_iterations": 8},
        "guess": {"kind": "points", "time": [0, 1, 2], "values": {"q1": [0, 0.5, "1/1"]}},
        "known": [{"quantity": "objective", "value": 58.8, "tolerance": 1e-6, "source": "a test"}],
    }


def hop() -> dict[str, Any]:
    """Stance (explicit), flight (closed form) and landing (residual), linked, with a static."""
    return {
        "name": "hop",
        "static": {"k": {"bounds": [1, 100], "guess": "10*pi"}},
        "phases": [
            {
                "name": "stance",
                "system": {
                    "kind": "second_order",
                    "parameters": {"m": 1, "g": 10},
                    "coordinates": ["x", "y"],
                    "controls": ["u"],
                    "define": {"tip": "y + sin(x)"},
                    "accelerations": {"x": "u/m", "y": "k*(1 - y) - g - 0.1*d(y)"},
                },
                "time": {"initial": [0, 1], "duration": [0.1, 2]},
                "bounds": {"y": [0, 1], "d(y)": [-9, 9], "d(u)": [-50, 50]},
                "initial": {"x": 0, "d(y)": [-1, 0]},
                "integrals": {"effort": "u^2 + dd(u)^2 + d(tip)^2"},
            },
            {
                "name": "flight",
                "system": {
                    "kind": "closed_form",
                    "parameters": {"g": 10},
                    "define": {"since": "t - initial.t"},
                    "states": {
                        "h": "initial.h + initial.v*since - g*since^2/2",
                        "v": "initial.v - g*since",
                    },
                },
                "time": {"duration": [0.1, 1]},
                "path": [{"name": "above", "expression": "h + 0*since", "lower": 0}],
            },
            {
                "name": "landing",
                "system": {
                    "kind": "second_order",
                    "coordinates": ["y"],
                    "controls": ["f"],
                    "residual": ["dd(y) - f + k*(y - 1)"],
                },
                "time": {"final": [0.5, 4]},
                "method": {"kind": "dircol5i", "segments": 6},
                "guess": {"kind": "constant", "values": {"y": 1}},
            },
        ],
        "linkages": [
            {"name": "rise", "expression": "stance.final.d(tip) - flight.initial.v", "lower": 0},
            {"name": "touch", "expression": "flight.final.h - landing.initial.y", "upper": 0},
        ],
        "objective": {"minimize": "stance.effort + k + landing.final.dd(y)^2 + flight.duration"},
        "method": {"kind": "radau", "segments": 5},
        "guess": {"kind": "constant", "values": {"u": "m", "h": 1}},
        "stages": [
            {"objective": {"minimize": "0"}, "refinement": None},
            {"objective": {"minimize": "stance.effort"}, "refinement": {}},
        ],
    }


def changed(path: str, value: Any, problem: dict[str, Any] | None = None) -> dict[str, Any]:
    """The problem, the cart-pole unless given, with the value at ``path`` replaced.

    The parts of the path stand apart by blanks.
    """
    problem = cart_pole() if problem is None else problem
    *way, last = (int(part) if part.isdigit() else part for part in path.split())
    place: Any = problem
    for part in way:
        place = place[part]
    place[last] = value
    return problem


def issues(data: Any) -> list[Issue]:
    """What is wrong with the data, which must be wrong."""
    with pytest.raises(BadProblem) as caught:
        read_problem(data)
    return caught.value.issues
