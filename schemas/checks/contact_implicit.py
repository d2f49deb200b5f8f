"""What contact-implicit methods cannot do, and settings of theirs that contradict each other."""

from collections.abc import Iterator
from dataclasses import dataclass

from schemas.checks import contact_points, stepped
from schemas.checks.constants import Interval
from schemas.checks.lengths import lengths
from schemas.checks.masses import Numbers
from schemas.errors import Issue
from schemas.expressions import names_in
from schemas.mechanisms import Mechanism
from schemas.methods import ContactImplicit, ContactImplicitPolished, Hybrid
from schemas.phases import Phase
from schemas.pointers import Part, pointer
from schemas.problem import Problem
from schemas.systems import ClosedForm
from schemas.urdf import Urdf

_Place = tuple[Part, ...]

_SAME = 1e-9
"""Relative; by so much may sums of decimal times differ."""


@dataclass(frozen=True, slots=True)
class Stepped:
    """A phase that is stepped through contact.

    ``own`` is the place of its method, ``settings`` that of the steps' settings, ``lasting`` its
    shortest and longest duration, s, where they are known.
    """

    phase: Phase
    method: ContactImplicit | ContactImplicitPolished
    place: _Place
    own: _Place
    lasting: Interval | None

    @property
    def steps(self) -> ContactImplicit:
        """The settings of the steps."""
        return (
            self.method.steps if isinstance(self.method, ContactImplicitPolished) else self.method
        )

    @property
    def settings(self) -> _Place:
        """Where they stand."""
        polished = isinstance(self.method, ContactImplicitPolished)
        return (*self.own, "steps") if polished else self.own

    def at(self, *parts: Part) -> str:
        """A pointer into the phase."""
        return pointer(*self.place, *parts)


def stepped_phases(problem: Problem) -> Iterator[Stepped]:
    """The phases that a contact-implicit method is for."""
    for index, (phase, lasting) in enumerate(zip(problem.phases, lengths(problem), strict=True)):
        method = phase.method or problem.method
        if isinstance(phase.system, ClosedForm):
            continue
        if isinstance(method, ContactImplicit | ContactImplicitPolished):
            place: _Place = ("phases", index)
            own: _Place = (*place, "method") if phase.method else ("method",)
            yield Stepped(phase, method, place, own, lasting)


def check(problem: Problem) -> Iterator[Issue]:
    """Systems, settings, contacts and names of every phase that is stepped through contact."""
    found = list(stepped_phases(problem))
    told: set[Issue] = set()
    for one in found:
        for issue in _of_phase(one):
            if issue not in told:  # phases may share one method
                told.add(issue)
                yield issue
    yield from _together(problem, found)
    yield from stepped.check(problem, [int(one.place[1]) for one in found])


def _of_phase(one: Stepped) -> Iterator[Issue]:
    yield from _settings(one)
    system = one.phase.system
    if not isinstance(system, Mechanism | Urdf):
        yield Issue(
            pointer(*one.own, "kind"),
            f"{one.method.kind} is for mechanisms and urdf systems, that of the phase "
            f"'{one.phase.name}' is an {system.kind}",
            "write it as a mechanism, or choose another method, such as hermite_simpson",
        )
        return
    yield from _given(one, system)
    if isinstance(system, Urdf):
        yield from _in_space(one)
    else:
        yield from _bouncing(one, system)
    yield from contact_points.coincident(system, Numbers.of(one.phase, int(one.place[1])))
    if one.phase.periodic is not None and one.phase.periodic.impact is not None:
        yield Issue(
            one.at("periodic", "impact"),
            f"under {one.method.kind} an impact is a step like any other",
            "take 'impact' away: contacts land, and velocities jump, within the steps",
        )


def _settings(one: Stepped) -> Iterator[Issue]:
    steps = one.steps
    lower, upper = steps.step_bounds
    if not 0 < lower <= 1 <= upper:
        yield Issue(
            pointer(*one.settings, "step_bounds"),
            f"no steps of {lower:g} to {upper:g} times the mean one",
            "the lower bound is above 0 and at most 1, the upper one at least 1",
        )
    if steps.steps == "pairwise" and steps.segments % 2:
        yield Issue(
            pointer(*one.settings, "segments"),
            f"pairwise steps come in twos, and {steps.segments} is odd",
            f"take {steps.segments + 1} segments",
        )
    if steps.steps == "fixed" and one.lasting is not None and not _fixed(one.lasting):
        yield Issue(
            pointer(*one.settings, "steps"),
            f"fixed steps are those of a given time, and the length of the phase "
            f"'{one.phase.name}' is free",
            "let 'steps' be 'duration', or fix 'time'",
        )


def _fixed(lasting: Interval) -> bool:
    return lasting[1] - lasting[0] <= _SAME * max(1.0, abs(lasting[0]))


def _given(one: Stepped, system: Mechanism | Urdf) -> Iterator[Issue]:
    """What the solver finds, and the user need not say."""
    if system.mode:
        yield Issue(
            one.at("system", "mode"),
            f"under {one.method.kind} the solver finds what touches, and when",
            "take 'mode' away; for a sequence of your own choose hybrid",
        )
    if isinstance(system, Mechanism) and system.loops and system.loose:
        yield Issue(
            one.at("system", "loose"),
            f"under {one.method.kind} all forces of contacts and loops are variables",
            "take 'loose' away",
        )


def _in_space(one: Stepped) -> Iterator[Issue]:
    if isinstance(one.method, ContactImplicitPolished):
        yield Issue(
            pointer(*one.own, "kind"),
            "the polish is by hybrid collocation, which is for mechanisms in the plane; the "
            f"system of the phase '{one.phase.name}' is a urdf",
            "choose contact_implicit",
        )


def _bouncing(one: Stepped, system: Mechanism) -> Iterator[Issue]:
    """Restitution of surfaces and pairs that may touch."""
    numbers = Numbers.of(one.phase, int(one.place[1]))
    grounds = {pair.against for pair in system.touching.values() if pair.restitution is None}
    parts = [
        *(("surfaces", name, one.restitution) for name, one in system.surfaces.items()),
        *(("pairs", name, one.restitution) for name, one in (system.pairs or {}).items()),
    ]
    for field, name, given in parts:
        value = numbers.value(given)
        if given is None or value == 0 or (field == "surfaces" and name not in grounds):
            continue
        if value is None and all(n.name in system.parameters for n in names_in(given.tree)):
            continue  # another check refuses it
        size = "chosen by the solver" if value is None else f"of {value:g}"
        yield Issue(
            numbers.at(field, name, "restitution"),
            f"{one.method.kind} has no restitution, and that of '{name}' is {size}: laws for "
            "velocities do not pass the audit in an optimum",
            "leave it at 0; what bounces can be simulated, or be given as modes to hybrid",
        )


def _together(problem: Problem, found: list[Stepped]) -> Iterator[Issue]:
    """Settings of the problem, and methods that must agree."""
    if not found:
        return
    stepped_only = any(isinstance(one.method, ContactImplicit) for one in found)
    if stepped_only and problem.refinement is not None and problem.refinement.switches:
        yield Issue(
            pointer("refinement", "switches"),
            f"{found[0].method.kind} finds by itself when contacts change, and its steps are free",
            "take 'switches' away; for sharp times choose contact_implicit_polished",
        )
    for index, phase in enumerate(problem.phases):
        if isinstance(phase.method or problem.method, Hybrid):
            yield Issue(
                pointer("phases", index, *(("method",) if phase.method else ())),
                f"the phase '{phase.name}' has a given sequence of modes, and the phase "
                f"'{found[0].phase.name}' finds its own: both in one problem are not available",
                "solve them one after the other, or all by contact_implicit",
            )
    for one in found[1:]:
        if one.steps.relaxation != found[0].steps.relaxation:
            yield Issue(
                pointer(*one.settings, "relaxation"),
                "all phases are relaxed together, and this relaxation differs from that of the "
                f"phase '{found[0].phase.name}'",
                "give all of them the same",
            )
