"""What only numbers tell of a mechanism: poses it can have, coordinates without inertia.

And forces that its motion does not determine, and key poses of guesses.
"""

from collections.abc import Iterator, Mapping

from schemas.errors import Issue
from schemas.mechanisms import Mechanism
from schemas.phases import Phase
from solver.poses.clear import check_clear
from solver.poses.inertias import check_inertias
from solver.poses.keys import Posed, posed
from solver.poses.loose import loosened
from solver.poses.stand import check_poses
from solver.poses.tapes import Tapes

__all__ = ["Posed", "check_clear", "impossible", "loosened", "posed"]


def impossible(phase: Phase, index: int, statics: Mapping[str, float]) -> Iterator[Issue]:
    """Why a mechanism cannot stand as its phase asks it to, or cannot be accelerated."""
    if isinstance(phase.system, Mechanism):
        tapes = Tapes(phase.system, statics)
        yield from check_inertias(tapes, index)
        yield from check_poses(tapes, phase, index)
