"""A block on the ground that is pushed along it: stiction makes it stick, slip and stick (000)."""

from typing import Any

from schemas.problem import Problem
from schemas.reading import read_problem
from tests.support.stepped import problem

EFFORT = 16 / 3**0.5
"""The least integral of the force's square: m = 1, mu g = 2, one metre in three seconds."""


def pushed_block(**changes: Any) -> Problem:
    """From rest to rest over one metre; ``changes`` as of ``tests.support.stepped.problem``."""
    at_rest = {"y": 0, "d(x)": 0, "d(y)": 0}
    return problem(
        {
            "kind": "mechanism",
            "parameters": {"m": 1.0, "g": 9.81, "mu": "2/g"},
            "gravity": [0, "-g"],
            "bodies": {"carrier": {}, "block": {"mass": "m", "inertia": 0.1}},
            "joints": {
                "x": {"kind": "prismatic", "axis": [1, 0], "child": "carrier"},
                "y": {"kind": "prismatic", "parent": "carrier", "axis": [0, 1], "child": "block"},
            },
            "controls": ["f"],
            "forces": {"push": {"body": "block", "at": [0, 0], "direction": [1, 0], "value": "f"}},
            "contacts": {"foot": {"body": "block"}},
            "surfaces": {"ground": {"friction": "mu"}},
        },
        3.0,
        **{
            "bounds": {"f": [-50, 50], "x": [-2, 2], "y": [-1, 1]},
            "initial": {"x": 0, **at_rest},
            "final": {"x": 1, **at_rest},
            "integrals": {"effort": "f^2"},
            "objective": {"minimize": "effort"},
            "refinement": None,
        }
        | changes,
    )


def reread(problem: Problem, **changes: Any) -> Problem:
    """The same problem with other fields."""
    return read_problem(problem.model_dump(mode="json", exclude_defaults=True) | changes)
