"""Every name that an expression uses is declared and visible where it stands."""

from collections.abc import Iterator

from schemas.checks.places import Place, places, variables
from schemas.errors import Issue
from schemas.expressions import Name, names_in
from schemas.expressions.errors import quoted
from schemas.phases import Phase
from schemas.pointers import pointer
from schemas.problem import Problem
from schemas.suggest import did_you_mean

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
    elsewhere = _elsewhere(name, place.phase, along="t" in place.visible) if place.phase else ""
    if elsewhere:
        return elsewhere
    if name.lower() in ("nan", "inf", "infinity"):
        return "infinities have no name; leave an open limit out, or write null"
    if name in _TIMES:
        along = "t" in place.visible
        return "the time is t" if along else "the final time is final.t, the time taken duration"
    some = sorted(place.visible, key=lambda word: (word.count("."), word))
    near = did_you_mean(name, some)
    if near:
        return near
    return "known here: " + ", ".join(some[:_SHOWN]) + (", ..." if len(some) > _SHOWN else "")


def _elsewhere(name: str, phase: Phase, *, along: bool) -> str:
    """Why a name that is declared is not visible here."""
    if along and name in phase.integrals:
        return "an integral is known at the end only: in 'boundary' and in the objective"
    if along and (name == "duration" or name.startswith(("initial.", "final."))):
        return "the ends of a phase are known in 'boundary' and in the objective only"
    if name in phase.system.define:
        if along:
            return f"'{name}' is defined further down; an intermediate may use those before it"
        return "intermediates are known along the phase only; write the formula out"
    if not along and (name == "t" or name in variables(phase)):
        return f"write initial.{name} or final.{name}"
    return ""
