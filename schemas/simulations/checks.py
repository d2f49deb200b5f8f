"""What a well-formed simulation may still get wrong.

Its system and all its expressions are looked at as those of a problem of one phase: the checks of
`schemas.checks` say what they say there, at the places of the simulation.
"""

from collections.abc import Iterator, Mapping
from itertools import pairwise

from schemas import checks
from schemas.errors import Issue
from schemas.expressions import Expression, names_in, split
from schemas.expressions.errors import quoted
from schemas.habits import as_rate
from schemas.limits import MODEL_LIMITS
from schemas.mechanisms import Mechanism
from schemas.phases import Constraint, Phase, Time
from schemas.pointers import Part, parts_of, pointer
from schemas.problem import Problem, Static
from schemas.simulations.document import (
    Events,
    ExpressionSignal,
    GainSchedule,
    SampledSignal,
    Signal,
    Simulation,
    Smooth,
    SolutionSignal,
    TimeStepping,
)
from schemas.simulations.methods import check_method
from schemas.suggest import did_you_mean
from schemas.systems import ClosedForm, Ode, SecondOrder
from schemas.urdf import Urdf
from schemas.values import Bound, Scalar

Place = tuple[Part, ...]


def check(simulation: Simulation) -> Iterator[Issue]:
    """Every issue, those of this document's own kind first."""
    found = _torn(simulation)
    found = found or [*_method(simulation), *_names(simulation), *_signals(simulation)]
    expressions = list(_expressions(simulation))
    starts = range(0, max(len(expressions), 1), MODEL_LIMITS.constraints)
    for start in starts:
        if found:
            break
        some = range(start, min(start + MODEL_LIMITS.constraints, len(expressions)))
        problem = _as_problem(simulation, expressions, some)
        found = [_moved(one, expressions, start) for one in checks.check(problem)]
    yield from found or check_method(simulation)


def _torn(simulation: Simulation) -> list[Issue]:
    """Why the bodies of its mechanism do not hang together: then nothing else is said."""
    if not isinstance(simulation.system, Mechanism):
        return []
    bare = Phase(system=simulation.system, time=Time(duration=_fixed(Scalar.read(1))))
    return [_moved(one, [], 0) for one in checks.torn(Problem(phases=[bare]))]


def _as_problem(
    simulation: Simulation, expressions: list[tuple[Place, Expression]], rows: range
) -> Problem:
    """A problem whose only phase has the system, its start, and some of the expressions."""
    zero = Scalar.read(0)
    path = [
        Constraint(name=_label(simulation, row), expression=expressions[row][1], lower=zero)
        for row in rows
    ]
    phase = Phase(
        system=simulation.system,
        time=Time(initial=_fixed(simulation.start), duration=_fixed(simulation.duration)),
        initial={name: _fixed(value) for name, value in simulation.initial.items()},
        path=path,
    )
    static = {name: Static(bounds=_fixed(value)) for name, value in simulation.static.items()}
    return Problem(phases=[phase], static=static)


def _label(simulation: Simulation, row: int) -> str:
    """A name for an expression: the guard's own, else one that nobody gives."""
    guards = simulation.events
    return guards[row].name if row < len(guards) else f"_expression_{row}"


def _fixed(value: Scalar) -> Bound:
    return Bound(value, value)


def _expressions(simulation: Simulation) -> Iterator[tuple[Place, Expression]]:
    """Every expression beside the system's: those of the guards first."""
    for row, guard in enumerate(simulation.events):
        yield ("events", row, "expression"), guard.expression
    for row, guard in enumerate(simulation.events):
        for name, expression in guard.reset.items():
            yield ("events", row, "reset", name), expression
    feedback = simulation.feedback
    references = feedback.reference if feedback else None
    for place, signal in ((("controls",), simulation.controls), (_REFERENCE, references)):
        if isinstance(signal, ExpressionSignal):
            for name, expression in signal.values.items():
                yield (*place, "values", name), expression
    for control, row_of in ((feedback and feedback.gains) or {}).items():
        for state, expression in row_of.items():
            yield ("feedback", "gains", control, state), expression


_REFERENCE = ("feedback", "reference")
_HOMES: tuple[tuple[tuple[str, ...], Place], ...] = (
    (("phases", "0", "system"), ("system",)),
    (("phases", "0", "initial"), ("initial",)),
    (("phases", "0", "time", "initial"), ("start",)),
    (("phases", "0", "time", "duration"), ("duration",)),
    (("phases", "0", "time"), ("duration",)),
    (("phases", "0"), ()),
)


def _moved(issue: Issue, expressions: list[tuple[Place, Expression]], start: int) -> Issue:
    """An issue of the problem, at its place in the simulation; its rows begin at ``start``."""
    parts = parts_of(issue.pointer)
    message = issue.message.replace("a path constraint", "an event")
    place: Place = tuple(parts)
    if parts[:3] == ["phases", "0", "path"]:
        place, _ = expressions[start + int(parts[3])]
        place = (*place[:2], "name") if parts[4:] == ["name"] else place
    elif parts[:1] == ["static"]:
        place = tuple(part for part in parts if part != "bounds")
    else:
        for old, new in _HOMES:
            if tuple(parts[: len(old)]) == old:
                place = (*new, *parts[len(old) :])
                break
    return Issue(pointer(*place), message, issue.hint, issue.column)


def _method(simulation: Simulation) -> Iterator[Issue]:
    """What a method cannot do."""
    method, system = simulation.method, simulation.system
    if isinstance(system, ClosedForm):
        yield Issue(
            pointer("system", "kind"),
            "a closed form gives the motion itself; there is nothing to simulate",
            "write the equations of motion, as an 'ode' or a 'second_order' system",
        )
    if isinstance(method, TimeStepping) and isinstance(system, Ode | SecondOrder):
        yield Issue(
            pointer("method", "kind"),
            "time stepping finds the impulses of contacts: it takes mechanisms",
            "write 'smooth', or 'events' where there are guards",
        )
    if isinstance(system, Urdf) and not isinstance(method, Smooth):
        yield Issue(
            pointer("method", "kind"),
            f"the method '{method.kind}' does not know the contacts of robots in space",
            "write 'smooth', and which contacts touch in the system's 'mode'",
        )
    if simulation.events and not isinstance(method, Events):
        yield Issue(
            pointer("events"),
            f"the method '{method.kind}' knows no events",
            'write "method": {"kind": "events"}',
        )
    mode = getattr(system, "mode", {})
    if mode and not isinstance(method, Smooth):
        yield Issue(
            pointer("system", "mode"),
            f"the method '{method.kind}' finds the mode by itself",
            "leave it out: the mode at the start follows from the initial state",
        )


def _names(simulation: Simulation) -> Iterator[Issue]:
    """States, where states are named."""
    states = simulation.system.state_names
    yield from _known(simulation.initial, states, ("initial",), "state")
    for row, guard in enumerate(simulation.events):
        yield from _known(guard.reset, states, ("events", row, "reset"), "state")
    if feedback := simulation.feedback:
        gains = feedback.gains if feedback.gains is not None else _gains(feedback.schedule)
        root: Place = (
            "feedback",
            *(("gains",) if feedback.gains is not None else ("schedule", "gains")),
        )
        yield from _known(gains, simulation.system.control_names, root, "control")
        for control, row_of in gains.items():
            yield from _known(row_of, states, (*root, control), "state")
        if feedback.schedule:
            place = ("feedback", "schedule")
            yield from _increasing(feedback.schedule.time, (*place, "time"))
            for control, rows in feedback.schedule.gains.items():
                yield from _counted(rows, len(feedback.schedule.time), (*place, "gains", control))


def _gains(schedule: GainSchedule | None) -> Mapping[str, Mapping[str, object]]:
    return schedule.gains if schedule else {}


def _signals(simulation: Simulation) -> Iterator[Issue]:
    system = simulation.system
    yield from _signal(simulation.controls, system.control_names, ("controls",), "control")
    if simulation.feedback:
        reference = simulation.feedback.reference
        yield from _signal(reference, system.state_names, _REFERENCE, "state")


def _signal(signal: Signal | None, names: list[str], root: Place, kind: str) -> Iterator[Issue]:
    match signal:
        case ExpressionSignal():
            yield from _known(signal.values, names, (*root, "values"), kind)
            if kind == "control":
                yield from _circular(signal, names, root)
        case SampledSignal():
            yield from _known(signal.values, names, (*root, "values"), kind)
            yield from _increasing(signal.time, (*root, "time"))
            yield from _counted(signal.values, len(signal.time), (*root, "values"))
        case SolutionSignal():
            for row, phase in enumerate(signal.phases):
                known = {name for group in phase.curves.values() for name in group.coefficients}
                for name in names:
                    if name not in known:
                        yield Issue(
                            pointer(*root, "phases", row, "curves"),
                            f"there is no curve of the {kind} '{name}'",
                            "take the result of a problem with this system",
                        )


def _circular(signal: ExpressionSignal, controls: list[str], root: Place) -> Iterator[Issue]:
    for name, expression in signal.values.items():
        for used in names_in(expression.tree):
            prefix, _, base = split(used.name)
            if prefix + base in controls:
                yield Issue(
                    pointer(*root, "values", name),
                    f"a control cannot depend on the control {quoted(used.name)}",
                    "controls may use time, states, and what the system defines of them",
                    used.column,
                )


def _known(
    given: Mapping[str, object], names: list[str], root: Place, kind: str
) -> Iterator[Issue]:
    for name in given:
        if name not in names:
            hint = as_rate(name, names) or did_you_mean(name, names)
            hint = hint or f"the {kind}s are " + ", ".join(names[:12])
            hint = hint if names else f"the system has no {kind}s"
            yield Issue(pointer(*root, name), f"{quoted(name)} is not a {kind}", hint)


def _increasing(time: list[float], place: Place) -> Iterator[Issue]:
    for row, (before, after) in enumerate(pairwise(time), 1):
        if not before < after:
            message = f"times increase, but {after:g} follows {before:g}"
            yield Issue(pointer(*place, row), message)
            return


def _counted(values: Mapping[str, list[float]], count: int, root: Place) -> Iterator[Issue]:
    for name, row in values.items():
        if len(row) != count:
            yield Issue(pointer(*root, name), f"{len(row)} values for {count} times")
