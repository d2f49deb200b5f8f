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


def changed(path: str, value: Any) -> dict[str, Any]:
    """The cart-pole with the value at ``path``, parts apart by blanks, replaced."""
    problem = cart_pole()
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
