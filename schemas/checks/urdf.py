"""Bounds of a phase beside the limits of a URDF text: both hold, so both must be possible."""

from collections.abc import Iterator

from schemas.checks.constants import Constants
from schemas.errors import Issue
from schemas.pointers import Part, pointer
from schemas.problem import Problem
from schemas.urdf import Urdf


def check(problem: Problem) -> Iterator[Issue]:
    """Values that the text's limits leave none of."""
    for index, phase in enumerate(problem.phases):
        if not isinstance(phase.system, Urdf):
            continue
        root: tuple[Part, ...] = ("phases", index)
        constants = Constants.of(phase, root, problem.static)
        for field in ("bounds", "initial", "final"):
            for name, bound in getattr(phase, field).items():
                limits = phase.system.intervals.get(name)
                given = constants.interval(bound, (*root, field, name))
                if limits and given and (given[0] > limits[1] or given[1] < limits[0]):
                    yield Issue(
                        pointer(*root, field, name),
                        f"no value of '{name}' keeps both this and the text's own limits, "
                        f"{limits[0]:g} to {limits[1]:g}",
                        'change one of them, or write "limits": false in the system',
                    )
