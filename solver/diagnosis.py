"""Where a model breaks at its start: which expression, when, and a pointer into the problem."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from schemas.errors import InvalidModel, Issue
from schemas.expressions import Expression
from schemas.mechanisms import Mechanism
from schemas.phases import Phase as PhaseSpec
from schemas.pointers import pointer
from schemas.problem import Problem
from solver.model import OPEN, Model, Phase
from solver.nlp.program import Program, RowLabel
from solver.nlp.task import NlpTask
from solver.numeric import along
from solver.transcribe import Setting

Array = NDArray[np.float64]

_SAMPLES = 401
_PUSH = 1e-2  # of a variable's size, and of the width of its bounds
_HINT = (
    "Give a guess, or bounds, that keep the motion where this expression has a value "
    "(no division by zero, no root or logarithm of a negative number)."
)
_SLOPE_HINT = (
    "Roots have no slope at zero: keep the motion away from there by bounds or ends, or smooth "
    "the expression, as in sqrt(x + 1e-6)."
)


def check_start(
    problem: Problem,
    model: Model,
    program: Program,
    task: NlpTask,
    setting: Setting,
) -> None:
    """Refuse a start at which the program has no finite values or slopes.

    Tried a little inside of the bounds, where an interior-point solver starts.

    Raises
    ------
    InvalidModel
        Naming the expressions that have none, and the first time at which they have none.
    """
    start = _inside(task)
    objective, rows = (part.full().ravel() for part in task.nlp.evaluate(start))
    if not (np.isfinite(objective).all() and np.isfinite(rows).all()):
        issues = [
            issue
            for index in range(len(model.phases))
            for issue in _broken(problem, model, index, setting)
        ]
        raise InvalidModel(issues or _by_rows(problem, program, ~np.isfinite(rows), "value", _HINT))
    _, gradient = task.nlp.gradient(start, [])
    _, jacobian = task.nlp.jacobian(start, [])
    steep = np.zeros(program.rows, dtype=bool)
    steep[np.array(jacobian.row())[~np.isfinite(jacobian.nonzeros())]] = True
    if steep.any() or not np.isfinite(gradient.full()).all():
        raise InvalidModel(_by_rows(problem, program, steep, "slope", _SLOPE_HINT))


def _inside(task: NlpTask) -> Array:
    """The start, moved off its bounds."""
    room = np.minimum(_PUSH, _PUSH * (task.upper - task.lower))
    return np.clip(task.start, task.lower + room, task.upper - room)


def _broken(problem: Problem, model: Model, index: int, setting: Setting) -> Iterator[Issue]:
    """Expressions along a phase that have no value somewhere on its guess."""
    spec, phase, guess = problem.phases[index], model.phases[index], setting.guesses[index]
    form = phase.chain  # whatever the method: it needs no natives
    fractions = np.linspace(0.0, 1.0, _SAMPLES)
    times = guess.start + (guess.end - guess.start) * fractions
    x = _within(phase, form.states, guess.sample(form.states, fractions))
    u = _within(phase, form.controls, guess.sample(form.controls, fractions))
    named = list(_expressions(spec))
    names = [static.name for static in model.statics]
    given = dict(zip(names, setting.statics, strict=True))
    given |= {f"initial.{name}": float(row[0]) for name, row in zip(form.states, x, strict=True)}
    given["initial.t"] = guess.start
    with np.errstate(all="ignore"):
        trees = [expression.tree for _, expression in named]
        values = along(form, trees, given)(times, x, u)
    for (place, _), row in zip(named, values, strict=True):
        bad = np.flatnonzero(~np.isfinite(row))
        if len(bad):
            when = f"first at t = {times[bad[0]]:.4g} s"
            message = f"has no finite value at the initial guess, {when}"
            yield Issue(f"/phases/{index}{place}", message, _HINT)


def _within(phase: Phase, names: Sequence[str], values: Array) -> Array:
    """A guess (names, samples) clipped to its limits, as the program's start is."""
    inside = values.copy()
    for row, name in enumerate(names):
        inside[row] = np.clip(inside[row], *phase.bounds.get(name, OPEN))
        inside[row, 0] = np.clip(inside[row, 0], *phase.initial.get(name, OPEN))
        inside[row, -1] = np.clip(inside[row, -1], *phase.final.get(name, OPEN))
    return inside


def _by_rows(
    problem: Problem, program: Program, bad: NDArray[np.bool_], what: str, hint: str
) -> list[Issue]:
    """One issue for each expression behind the bad rows; the objective's where there are none."""
    labels = [label for label, broken in zip(program.labels(), bad, strict=True) if broken]
    pointers = dict.fromkeys(_pointer(problem, label) for label in labels)
    message = f"has no finite {what} at the initial guess"
    return [Issue(place, message, hint) for place in pointers or ["/objective/minimize"]]


def _pointer(problem: Problem, label: RowLabel) -> str:
    """Where the expression behind a row stands."""
    for index, phase in enumerate(problem.phases):
        pointers = _equations(phase)
        pointers |= {f"integral {name}": f"integrals/{name}" for name in phase.integrals}
        for field, rows in (("path", phase.path), ("boundary", phase.boundary)):
            pointers |= {
                f"{field} {row.name}": f"{field}/{number}/expression"
                for number, row in enumerate(rows)
            }
        if label.name in pointers and label.phase == index:
            return f"/phases/{index}/{pointers[label.name]}"
    links = {f"linkage {row.name}": number for number, row in enumerate(problem.linkages)}
    if label.name in links and label.phase is None:
        return f"/linkages/{links[label.name]}/expression"
    return "/guess"


def _equations(phase: PhaseSpec) -> dict[str, str]:
    """The rows that come of each equation of motion, and where it stands."""
    pointers: dict[str, str] = {}
    if isinstance(phase.system, Mechanism):  # all of it is in every row
        return {f"dynamics {name}": "system" for name in phase.system.coordinates}
    for place, _, _ in phase.system.equations():
        field, name = place
        where = f"system/{field}/{name}"
        labels = [f"defect {name}"]
        if field in ("accelerations", "residual"):
            labels = [f"defect d({name})", f"dynamics {name}"]
        pointers |= dict.fromkeys(labels, where)
    return pointers


def _expressions(phase: PhaseSpec) -> Iterator[tuple[str, Expression]]:
    system = phase.system
    for name, expression in system.define.items():
        yield f"/system/define/{name}", expression
    for place, _, expression in system.equations():
        yield "/system" + pointer(*place), expression
    for name, expression in phase.integrals.items():
        yield f"/integrals/{name}", expression
    for index, row in enumerate(phase.path):
        yield f"/path/{index}/expression", row.expression
