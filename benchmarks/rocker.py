"""A plank with a round underside, on as many contact points as are asked for."""

from typing import Any

RADIUS, HALF, MASS = 2.0, 0.5, 2.0
"""m, m, kg: of the circle that the points lie on, of the plank, and its mass."""


def rocker(contacts: int, segments: int) -> dict[str, Any]:
    """Push the plank 0.3 m over the ground from rest to rest in 1 s, at least force squared.

    A floating body: three coordinates, two forces, ``contacts`` pairs.
    """
    points = {
        f"p{i}": {"body": "plank", "at": [x, _height(x)]} for i, x in enumerate(_places(contacts))
    }
    rest = {f"plank.{name}": 0 for name in ("d(x)", "d(y)", "d(angle)")}
    push = {"body": "plank", "at": [0, 0.1], "frame": "world"}
    phase = {
        "name": "push",
        "system": {
            "kind": "mechanism",
            "bodies": {"plank": {"mass": MASS, "inertia": 0.2, "com": [0, 0.1]}},
            "joints": {"base": {"kind": "floating", "child": "plank"}},
            "contacts": points,
            "surfaces": {"ground": {"friction": 0.4}},
            "controls": ["fx", "fy"],
            "forces": {
                "along": push | {"direction": [1, 0], "value": "fx"},
                "up": push | {"direction": [0, 1], "value": "fy"},
            },
        },
        "time": {"final": 1},
        "bounds": {
            "fx": [-20, 20],
            "fy": [-20, 20],
            "plank.x": [-1, 1],
            "plank.y": [-0.1, 0.5],
            "plank.angle": [-1, 1],
        },
        "initial": {"plank.x": 0, **rest},
        "final": {"plank.x": 0.3, **rest},
        "integrals": {"effort": "fx^2 + fy^2"},
    }
    return {
        "name": f"plank on {contacts} points",
        "phases": [phase],
        "objective": {"minimize": "effort"},
        "method": {"kind": "contact_implicit", "segments": segments, "steps": "fixed"},
        "refinement": None,
    }


def _places(contacts: int) -> list[float]:
    """Along the plank, evenly; one is in its middle."""
    if contacts == 1:
        return [0.0]
    return [HALF * (2 * i / (contacts - 1) - 1) for i in range(contacts)]


def _height(x: float) -> float:
    return RADIUS - float((RADIUS**2 - x**2) ** 0.5)
