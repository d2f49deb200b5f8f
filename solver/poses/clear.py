"""Ends of phases that are stepped through contact: inside of nothing, within the joints' limits."""

from collections.abc import Collection, Iterator

from schemas.errors import InvalidModel, Issue
from schemas.expressions import names_in
from schemas.mechanisms import Mechanism
from schemas.methods import ContactImplicit, ContactImplicitPolished
from schemas.phases import Phase
from schemas.problem import Problem
from schemas.urdf import Urdf
from solver.poses.stand import check_poses
from solver.poses.sunk import sunk
from solver.poses.tapes import Tapes


def check_clear(problem: Problem) -> None:
    """Refuse ends of which every pose is inside of something.

    Systems of which the solver chooses lengths are let pass: so may be the poses. In space only
    poses that are given as a whole are looked at.

    Parameters
    ----------
    problem
        As posted, the limits of joints among its bounds (``solver.mechanics.limited``).

    Raises
    ------
    InvalidModel
        With the depth in m, the contact, and a pose close by that is clear.
    """
    issues = [
        issue
        for index, phase in enumerate(problem.phases)
        if isinstance(phase.method or problem.method, ContactImplicit | ContactImplicitPolished)
        for issue in _buried(phase, index, problem.static)
    ]
    if issues:
        raise InvalidModel(issues)


def _buried(phase: Phase, index: int, statics: Collection[str]) -> Iterator[Issue]:
    system = phase.system
    if not isinstance(system, Mechanism | Urdf):
        return
    used = {name.name for _, one in system.constants() for name in names_in(one.tree)}
    if used & set(statics):
        return
    if isinstance(system, Urdf):
        yield from sunk(phase, index, system)
    else:
        yield from check_poses(Tapes(system, {}), phase, index, stepped=True)
