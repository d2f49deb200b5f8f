"""Sequences of modes and periods: names that exist, modes that can follow each other."""

from collections.abc import Iterator, Mapping, Sequence

from schemas.errors import Issue
from schemas.expressions import Expression, ExpressionError, constant
from schemas.mechanisms import Mechanism
from schemas.methods import ChebyshevLobatto, Hybrid, HybridMode, MultipleShooting
from schemas.periodic import Impact, Periodic
from schemas.phases import Phase
from schemas.pointers import Part, pointer
from schemas.problem import Problem
from schemas.resolve import scalar
from schemas.suggest import did_you_mean
from schemas.systems import System

_Place = tuple[Part, ...]


def check(problem: Problem) -> Iterator[Issue]:
    """Of every phase: its sequence, its period, and methods that let contacts drift."""
    for index, phase in enumerate(problem.phases):
        place: _Place = ("phases", index)
        method = phase.method or problem.method
        own: _Place = (*place, "method") if phase.method else ("method",)
        if isinstance(method, Hybrid):
            yield from _hybrid(phase, method, place, own)
        elif isinstance(method, ChebyshevLobatto | MultipleShooting) and _holds(phase.system):
            yield Issue(
                pointer(*own, "kind"),
                f"{method.kind} lets contacts and loops drift, and the phase '{phase.name}' has "
                "such",
                "choose hermite_simpson, radau or trapezoidal",
            )
        if phase.periodic is not None:
            sequence = method.sequence if isinstance(method, Hybrid) else []
            yield from _periodic(phase.system, phase.periodic, sequence, (*place, "periodic"))


def _holds(system: System) -> bool:
    return isinstance(system, Mechanism) and bool(system.mode or system.loops)


def _hybrid(phase: Phase, method: Hybrid, place: _Place, own: _Place) -> Iterator[Issue]:
    system = phase.system
    if not isinstance(system, Mechanism):
        yield Issue(
            pointer(*own, "kind"),
            f"hybrid is for mechanisms, the system of the phase '{phase.name}' is an {system.kind}",
            "write modes of other systems as phases, with linkages between them",
        )
        return
    if system.mode:
        yield Issue(
            pointer(*place, "system", "mode"),
            "under hybrid, the sequence says what touches",
            "take 'mode' away",
        )
    names: set[str] = set()
    for index, mode in enumerate(method.sequence):
        where = (*own, "sequence", index)
        if mode.name in names:
            message = f"'{mode.name}' is already the name of a mode of this sequence"
            yield Issue(pointer(*where, "name"), message, "give each its own name")
        names.add(mode.name)
        yield from _known(mode.contacts, list(system.touching), (*where, "contacts"))


def _known(
    names: Sequence[str] | Mapping[str, object], known: list[str], place: _Place
) -> Iterator[Issue]:
    """Contacts that the mechanism has."""
    for index, name in enumerate(names):
        if name not in known:
            part = name if isinstance(names, Mapping) else index
            hint = did_you_mean(name, known) or "known here: " + ", ".join(known[:12])
            yield Issue(pointer(*place, part), f"there is no contact '{name}'", hint)


def _periodic(
    system: System, periodic: Periodic, sequence: Sequence[HybridMode], place: _Place
) -> Iterator[Issue]:
    states = system.state_names
    yield from _swaps(system, periodic, place)
    for index, name in enumerate(periodic.free):
        if name not in states:
            hint = did_you_mean(name, states) or "the states are " + ", ".join(states[:12])
            yield Issue(pointer(*place, "free", index), f"'{name}' is not a state", hint)
    if periodic.impact is None:
        return
    if not isinstance(system, Mechanism):
        yield Issue(
            pointer(*place, "impact"),
            f"impacts are of mechanisms, this system is an {system.kind}",
            "write the impact as linkages between final and initial values",
        )
        return
    yield from _impact(system, periodic, periodic.impact, sequence, (*place, "impact"))


def _swaps(system: System, periodic: Periodic, place: _Place) -> Iterator[Issue]:
    """Exchanged names are names of something, each once, and states become states."""
    known = {word for name in (*system.state_names, *system.control_names) for word in _words(name)}
    if isinstance(system, Mechanism):
        groups = (system.bodies, system.joints, system.contacts, system.touching, system.motors)
        known |= {name for group in groups for name in group} | set(system.points)
    seen: set[str] = set()
    for index, pair in enumerate(periodic.swap):
        for side, name in enumerate(pair):
            where = pointer(*place, "swap", index, side)
            if name not in known:
                hint = did_you_mean(name, sorted(known))
                yield Issue(where, f"there is nothing called '{name}' to exchange", hint)
            elif name in seen:
                yield Issue(where, f"'{name}' is exchanged twice", "name it in one pair")
            seen.add(name)
    if known >= seen and isinstance(system, Mechanism):
        yield from _unlike(system, periodic, place)
    if known >= seen:
        lost = [
            name for name in system.state_names if periodic.swapped(name) not in system.state_names
        ]
        if lost:
            yield Issue(
                pointer(*place, "swap"),
                f"the exchange makes '{periodic.swapped(lost[0])}' of '{lost[0]}', which is no "
                "state",
                "exchange all names of one side with those of the other: joints, bodies, contacts",
            )


def _unlike(system: Mechanism, periodic: Periodic, place: _Place) -> Iterator[Issue]:
    """Bodies that are exchanged are alike; what rests on free parameters is compared as text."""
    numbers = _Numbers(system)
    for index, (one, two) in enumerate(periodic.swap):
        if one not in system.bodies or two not in system.bodies:
            continue
        a, b = (
            [numbers.of(body.mass), numbers.of(body.inertia), *map(numbers.of, body.com)]
            for body in (system.bodies[one], system.bodies[two])
        )
        if a != b:
            yield Issue(
                pointer(*place, "swap", index),
                f"'{one}' and '{two}' differ in mass, inertia or centre of mass",
                "only bodies that are alike can stand for each other",
            )


class _Numbers:
    """Constants of a mechanism as numbers, or as their texts."""

    def __init__(self, system: Mechanism) -> None:
        self._known: dict[str, float] = {}
        for name, value in system.parameters.items():
            try:
                self._known[name] = scalar(value, self._known)
            except ExpressionError:  # another check names it
                continue

    def of(self, expression: Expression | None) -> float | str | None:
        """The number, where there is one."""
        if expression is None:
            return None
        try:
            return constant(expression.tree, self._known)
        except ExpressionError:
            return expression.text


def _words(name: str) -> Iterator[str]:
    head, _, inner = name.partition("(")
    yield from head.split(".")
    if inner:
        yield inner[:-1]


def _impact(
    system: Mechanism,
    periodic: Periodic,
    impact: Impact,
    sequence: Sequence[HybridMode],
    place: _Place,
) -> Iterator[Issue]:
    """Contacts exist; with a sequence, they agree with its last and its first mode."""
    unknown = [
        *_known(impact.lands, list(system.touching), (*place, "lands")),
        *_known(impact.leaves, list(system.touching), (*place, "leaves")),
    ]
    yield from unknown
    if unknown or not sequence:
        return
    before = set(sequence[-1].contacts)
    after = {periodic.swapped(name) for name in sequence[0].contacts}
    for what, given, needed in (
        ("lands", set(impact.lands), after - before),
        ("leaves", set(impact.leaves), before - after),
    ):
        if given != needed:
            told = ", ".join(sorted(needed)) or "none"
            yield Issue(
                pointer(*place, what),
                f"from the last mode to the first one, exchanged, these are: {told}",
                "name those, as they are called before the exchange, or change the modes",
            )
