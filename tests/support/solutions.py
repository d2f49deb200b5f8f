"""A result with a closed form, for tests that need one without an engine.

A unit mass moves from 0 to 1 in 1 s at least force: q = 3 t^2 - 2 t^3, v = 6 t - 6 t^2,
u = 6 - 12 t (Kelly 2017, section 3).
"""

from itertools import pairwise
from typing import Any

from footfall.curves import Curves
from schemas.results import Solution

SEGMENTS = 4
_NODES = [-1.0, -1 / 3, 1 / 3, 1.0]


def states(t: float) -> list[float]:
    return [3 * t**2 - 2 * t**3, 6 * t - 6 * t**2]


def control(t: float) -> float:
    return 6 - 12 * t


def block_move() -> dict[str, Any]:
    """The result document."""
    knots = [index / SEGMENTS for index in range(SEGMENTS + 1)]
    pairs = [states(t) for t in knots]
    nodes = {"q": [q for q, _ in pairs], "v": [v for _, v in pairs]}
    phase = {
        "name": "move",
        "knots": knots,
        "groups": {
            "states": {"time": knots, "values": nodes},
            "controls": {"time": knots, "values": {"u": [control(t) for t in knots]}},
        },
        "curves": {"states": _curves(knots, ["q", "v"]), "controls": _curves(knots, ["u"])},
        "integrals": {"effort": 12.0},
    }
    return Solution.model_validate(_document(phase)).model_dump(mode="json")


def _curves(knots: list[float], names: list[str]) -> dict[str, Any]:
    values = []
    for start, end in pairwise(knots):
        times = [(start + end) / 2 + s * (end - start) / 2 for s in _NODES]
        values.append([states(t) if len(names) == 2 else [control(t)] for t in times])
    return Curves.through(names, knots, _NODES, values).to_dict()


def _document(phase: dict[str, Any]) -> dict[str, Any]:
    iteration = {
        "segments": SEGMENTS,
        "max_error": 1e-12,
        "errors": [1e-12] * SEGMENTS,
        "spans": [[index / SEGMENTS, (index + 1) / SEGMENTS] for index in range(SEGMENTS)],
        "objective": 12.0,
        "nlp_iterations": 3,
        "seconds": 0.01,
        "status": "optimal",
    }
    return {
        "name": "block",
        "status": "converged",
        "objective": 12.0,
        "message": "Converged.",
        "phases": [phase],
        "mesh_refinement": {"tolerance": 1e-6, "converged": True, "iterations": [iteration]},
        "certificate": {"verdict": "certified", "checks": []},
        "solver": {
            "backend": "none",
            "iterations": 3,
            "status": "optimal",
            "residuals": [],
            "variables": 15,
            "constraints": 8,
        },
        "timing": {"build": 0.1, "solve": 0.1, "refine": 0.0, "certify": 0.1, "total": 0.3},
        "reproduce": {"spec_sha256": "0" * 64, "versions": {}},
    }
