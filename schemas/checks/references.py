"""Every name that an expression uses is declared and visible where it stands."""

from collections.abc import Iterator

from schemas.checks.places import Place, places, variables
from schemas.errors import Issue
from schemas.expressions import Name, derivative, names_in, split, stem
from schemas.expressions.errors import quoted
from schemas.expressions.names import DERIVATIVES
from schemas.habits import as_rate
from schemas.phases import Phase
from schemas.pointers import pointer
from schemas.problem import Problem
from schemas.suggest import did_you_mean
from schemas.systems import ClosedForm

_SHOWN = 12
_TIMES = frozenset({"time", "t_final", "tfinal", "tf", "t_f", "T"})


def check(problem: Problem) -> Iterator[Issue]:
    """Unknown names, each once for an expression, at its first column."""
    for place in places(problem):
        unknown: dict[str, Name] = {}
        for name in names_in(place.expression.tree):
            if name.name not in place.visible:
                unknown.setdefault(name.name, name)
        for name in unknown.values():
            yield Issue(
                pointer(*place.parts),
                f"unknown name {quoted(name.name)}",
                _hint(name.name, place),
                name.column,
            )


def _hint(name: str, place: Place) -> str:
    if _is_height(place):
        return _of_height(name, place)
    elsewhere = _elsewhere(name, place, place.phase) if place.phase else ""
    told = elsewhere or _habit(name, place) or _misplaced(name, place)
    if told:
        return told
    _, order, _ = split(name)
    orders = place.visible.orders
    some = [derivative(word, order) for word in place.visible.words if orders[word] >= order]
    near = did_you_mean(name, some)
    if near:
        return near
    return "known here: " + ", ".join(some[:_SHOWN]) + (", ..." if len(some) > _SHOWN else "")


def _is_height(place: Place) -> bool:
    """Whether it is that of a surface of a mechanism."""
    return place.parts[-3:-2] == ("surfaces",) and place.parts[-1] == "height"


def _of_height(name: str, place: Place) -> str:
    """The ground stands still."""
    moves = name == "t" or (place.phase is not None and stem(name)[1] in variables(place.phase))
    still = "the ground does not move: its height is an expression of x and of constants"
    return still if moves else did_you_mean(name, place.visible.words) or still


def _habit(name: str, place: Place) -> str:
    """What to write for names that mean something elsewhere."""
    prefix, order, base = split(name)
    if order and prefix + base in place.visible:
        return f"'{prefix}{base}' has no derivatives"
    if base in DERIVATIVES and not order:
        return f"write {name}(x) for a derivative of x"
    if name.lower() in ("nan", "inf", "infinity"):
        return "infinities have no name; leave an open limit out, or write null"
    if name in _TIMES:
        along = "t" in place.visible
        return "the time is t" if along else "the final time is final.t, the time taken duration"
    return as_rate(name, (word for word, most in place.visible.orders.items() if most))


def _misplaced(name: str, place: Place) -> str:
    """What to write for names that stand here in another form."""
    prefix, order, base = split(name)
    ends = [derivative(f"{prefix}{end}.{base}", order) for end in ("initial", "final")]
    if all(end in place.visible for end in ends):
        return "write " + " or ".join(ends)
    of_phases = any(word.endswith(f".{base}") for word in place.visible.orders)
    if prefix and base in place.visible and not of_phases:
        return f"write {base}, without the name of a phase"
    return ""


def _elsewhere(name: str, place: Place, phase: Phase) -> str:
    """Why a name that is declared is not visible here."""
    prefix, order, base = split(name)
    varies = base in phase.system.define or base in variables(phase)
    if order and varies and isinstance(phase.system, ClosedForm):
        return "a motion in closed form has no derivatives; write the formula of the rate"
    if "t" in place.visible:
        return _along(name, place, phase)
    if prefix or not (name == "t" or varies):
        return ""
    mend = f"write initial.{name} or final.{name}"
    if place.parts[0] != "objective":
        return mend
    if name == "t":
        return f"{mend}, or duration for the time taken"
    return f"{mend}; what adds up along the phase is an integral: name it in 'integrals'"


def _along(name: str, place: Place, phase: Phase) -> str:
    prefix, _, base = split(name)
    if name == "duration" or prefix in ("initial.", "final."):
        return "the ends of a phase are known in 'boundary' and in the objective only"
    if prefix or base in place.visible:
        return ""
    if base in phase.integrals:
        return "an integral is known at the end only: in 'boundary' and in the objective"
    if base in phase.system.define:
        return f"'{base}' is defined further down; an intermediate may use those before it"
    closed = base in variables(phase)
    return (
        f"a closed form starts from the start of its phase: write initial.{base}" if closed else ""
    )
