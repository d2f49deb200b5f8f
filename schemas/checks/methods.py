"""Each phase's method can do what the phase asks for."""

from collections.abc import Iterator

from schemas.checks.degrees import nonlinear
from schemas.errors import Issue
from schemas.methods import ChebyshevLobatto, DirCol5i, MultipleShooting
from schemas.phases import Phase
from schemas.pointers import Part, pointer
from schemas.problem import Problem
from schemas.systems import ClosedForm, SecondOrder


def check(problem: Problem) -> Iterator[Issue]:
    """Methods of closed forms, of first-order systems, of residuals."""
    for index, phase in enumerate(problem.phases):
        place: tuple[Part, ...] = ("phases", index)
        if isinstance(phase.system, ClosedForm):
            if phase.method is not None:
                yield Issue(
                    pointer(*place, "method"),
                    "a motion in closed form is not transcribed",
                    "take the method away",
                )
            continue
        method = phase.method or problem.method
        chosen = (*place, "method", "kind") if phase.method else ("method", "kind")
        if isinstance(method, DirCol5i) and not isinstance(phase.system, SecondOrder):
            yield Issue(
                pointer(*chosen),
                f"dircol5i is for second_order systems, that of the phase '{phase.name}' is an "
                f"{phase.system.kind}",
                "write it as second_order, or choose another method, such as hermite_simpson",
            )
        if isinstance(method, ChebyshevLobatto) and not phase.system.control_names:
            yield Issue(
                pointer(*chosen),
                "chebyshev_lobatto states the dynamics at both ends of a segment, once more than "
                f"there are states: the phase '{phase.name}' has no control to make up for that",
                "choose another method, such as radau",
            )
        if isinstance(method, MultipleShooting):
            yield from _explicit(phase, place)


def _explicit(phase: Phase, place: tuple[Part, ...]) -> Iterator[Issue]:
    """Shooting solves residuals for the accelerations at every step, as linear equations."""
    if not isinstance(phase.system, SecondOrder) or phase.system.residual is None:
        return
    for index in nonlinear(phase.system, phase.system.residual):
        yield Issue(
            pointer(*place, "system", "residual", index),
            "multiple_shooting needs residuals that are linear in the accelerations",
            "choose a collocation method, such as hermite_simpson or dircol5i",
        )
