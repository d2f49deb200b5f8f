"""Small problems for the engine's tests, each a change of an example."""

from typing import Any

import examples
from schemas.reading import read_problem
from schemas.results import Solution
from solver import solve


def block(**changes: Any) -> dict[str, Any]:
    """The block of 003, section 7.7; ``phase`` and ``system`` change these parts."""
    document = examples.load("block_min_force")
    phase = changes.pop("phase", {})
    document["phases"][0]["system"] |= changes.pop("system", {})
    document["phases"][0] |= phase
    return document | changes


def solved(document: dict[str, Any], **options: Any) -> Solution:
    """Read and solve."""
    return solve(read_problem(document), **options)
