"""Each phase's method can do what the phase asks for."""

from collections.abc import Iterator

from schemas.checks.chains import Chains, nodes_in
from schemas.checks.degrees import nonlinear
from schemas.errors import Issue
from schemas.mechanisms import Mechanism
from schemas.methods import ChebyshevLobatto, DirCol5i, Method, MultipleShooting
from schemas.phases import Phase
from schemas.pointers import Part, pointer
from schemas.problem import Problem
from schemas.systems import ClosedForm, SecondOrder
from schemas.urdf import Urdf


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
        if isinstance(phase.system, Mechanism | Urdf):
            yield from _of_mechanism(phase, phase.system, method, place, chosen)
        elif isinstance(method, DirCol5i) and not isinstance(phase.system, SecondOrder):
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


def _of_mechanism(
    phase: Phase,
    system: Mechanism | Urdf,
    method: Method,
    place: tuple[Part, ...],
    chosen: tuple[Part, ...],
) -> Iterator[Issue]:
    """Forces of contacts and loops need methods that have such unknowns at their nodes."""
    if isinstance(method, DirCol5i) and _held(system):
        yield Issue(
            pointer(*chosen),
            f"dircol5i has no forces of contacts and loops, which the phase '{phase.name}' needs",
            "choose another method, such as radau",
        )
    if not isinstance(method, MultipleShooting):
        return
    chains, forces = Chains(system, native=True), ("normal", "tangential")
    for parts, label, expression in system.equations():
        for node, _ in chains.reached(nodes_in([expression])):
            held = node.base.rpartition(".")[2].startswith(forces) or node.base.startswith("loop.")
            if held or (node.base in system.coordinates and node.order > 1):
                yield Issue(
                    pointer(*place, "system", *parts),
                    f"multiple_shooting needs the {label} over coordinates and velocities only",
                    "choose a collocation method, such as hermite_simpson",
                )
                break


def _held(system: Mechanism | Urdf) -> bool:
    """Whether forces hold something all along."""
    return bool(system.mode) or (isinstance(system, Mechanism) and bool(system.loops))


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
