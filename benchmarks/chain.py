"""A chain of masses on a line, springs between them: a problem of any number of states."""

from typing import Any

STIFFNESS, MASS, DURATION, DISTANCE = 40.0, 1.0, 20.0, 1.0
"""N/m, kg, s, m: in this time a wave runs along 126 masses, so 30 are moved with ease."""


def chain(masses: int, segments: int) -> dict[str, Any]:
    """Move the chain by 1 m from rest to rest, pushing the first mass, at least force squared.

    ``2 * masses`` states: displacements in m, then velocities in m/s.
    """
    places = [f"x{i}" for i in range(1, masses + 1)]
    speeds = [f"v{i}" for i in range(1, masses + 1)]
    forces = {speed: f"({_force(i, masses)}) / m" for i, speed in enumerate(speeds, start=1)}
    rest = dict.fromkeys([*places, *speeds], 0)
    phase = {
        "name": "move",
        "system": {
            "kind": "ode",
            "parameters": {"k": STIFFNESS, "m": MASS},
            "states": [*places, *speeds],
            "controls": ["u"],
            "derivatives": dict(zip(places, speeds, strict=True)) | forces,
        },
        "time": {"initial": 0, "final": DURATION},
        "initial": rest,
        "final": rest | dict.fromkeys(places, DISTANCE),
        "integrals": {"effort": "u^2"},
    }
    return {
        "name": f"chain of {masses} masses",
        "phases": [phase],
        "objective": {"minimize": "effort"},
        "method": {"kind": "hermite_simpson", "segments": segments},
        "refinement": None,
    }


def _force(i: int, masses: int) -> str:
    """What acts on mass i: the push on the first, and the springs to its neighbours."""
    push = ["u"] if i == 1 else []
    left = [f"k*(x{i - 1} - x{i})"] if i > 1 else []
    right = [f"k*(x{i + 1} - x{i})"] if i < masses else []
    return " + ".join([*push, *left, *right]) or "0"
