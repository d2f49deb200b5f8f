"""Results of simulations with a closed form, for tests that need one without an engine."""

import math
from typing import Any

from footfall.curves import Curves
from schemas.simulated import SimulationResult

G = 9.81
END = 1.5


def height(t: float) -> float:
    """Of a point that leaves y = 0 at 9.81 m/s, in m."""
    return G * (t - t * t / 2)


def throw(frames: dict[str, Any] | None = None, **changes: Any) -> dict[str, Any]:
    """The result document of a throw; ``frames`` are those of its phase."""
    knots = [0.0, END]
    times = [END * share for share in (0, 0.5, 1)]
    values = [[height(t), G * (1 - t)] for t in times]
    curves = Curves.through(["y", "v"], knots, [-1, 0, 1], [values]).to_dict()
    columns = zip(*values, strict=True)
    group = {"time": times, "values": dict(zip("yv", map(list, columns), strict=True))}
    phase = {
        "name": "simulation",
        "knots": knots,
        "groups": {"states": group},
        "curves": {"states": curves},
        "frames": frames,
    }
    document = {
        "name": "throw",
        "status": "finished",
        "message": "1.5 s in 3 steps.",
        "phases": [phase],
        "timing": {"build": 0.01, "simulate": 0.02, "total": 0.03, "steps": 3},
        "reproduce": {"spec_sha256": "0" * 64, "versions": {"numpy": "2"}},
    }
    return SimulationResult.model_validate(document | changes).model_dump(mode="json")


def rolling(count: int = 31) -> dict[str, Any]:
    """Frames of a cart that rolls 1 m with a rod that turns once on it, and pushes the ground."""
    time = [END * index / (count - 1) for index in range(count)]
    share = [t / END for t in time]
    still = [0.0] * count
    return {
        "time": time,
        "bodies": {
            "cart": {"x": share, "y": still, "angle": still},
            "rod": {"x": share, "y": still, "angle": [2 * math.pi * s for s in share]},
        },
        "forces": {"wheel": {"x": share, "y": still, "fx": still, "fy": [10 * s for s in share]}},
        "scene": {
            "bodies": {
                "cart": {"outline": [[-0.2, 0], [0.2, 0], [0.2, 0.1], [-0.2, 0.1]], "com": [0, 0]},
                "rod": {"places": [[0, 0], [0, 0.5]], "com": [0, 0.25]},
            },
            "joints": {
                "x": {
                    "kind": "prismatic",
                    "body": "ground",
                    "child": "cart",
                    "at": [0, 0],
                    "end": [1, 0],
                },
                "pin": {"kind": "revolute", "body": "cart", "child": "rod", "at": [0, 0]},
            },
            "contacts": {"wheel": {"body": "cart", "at": [0, 0], "radius": 0.05}},
            "springs": {
                "coil": [{"body": "cart", "at": [0.2, 0]}, {"body": "rod", "at": [0, 0.5]}]
            },
            "surfaces": {"ground": [[-1, -0.05], [2, -0.05]]},
        },
    }
