"""From a posted sweep to its plan: every point checked, every mistake told where it was posted."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import islice, product
from typing import Any

from pydantic import ValidationError

from api.settings import ApiSettings
from schemas.errors import BadProblem, Issue
from schemas.expressions.errors import quoted
from schemas.guesses import Guess, RandomGuess
from schemas.limits import MODEL_LIMITS
from schemas.patching import NoPlace, replaced
from schemas.pointers import pointer
from schemas.problem import Limits, Problem
from schemas.reading import (
    MAX_ISSUES,
    Document,
    read_document,
    read_inlined,
    read_problem,
)
from schemas.suggest import did_you_mean
from schemas.sweeps import Kind, SweepPlan, SweepRequest, Values

_IN_A_ROW = 8
"""Points of a job, at the most, unless the request says more."""

_ONE_OF = "give one of 'grid', 'points' and 'multistart'"


@dataclass(frozen=True, slots=True)
class _Point:
    """What a point changes; where each of these values was posted, and where the point was."""

    values: Values
    places: dict[str, str]
    place: str


def plan(body: bytes, inline: Callable[[Document], Document], settings: ApiSettings) -> SweepPlan:
    """Check a posted sweep and all of its points.

    ``inline`` puts in what the problem only names. Raises BadProblem; its pointers lead into the
    posted document.
    """
    request = _request(read_document(body))
    base, problem = _base(request.problem, inline)
    kind = _kind(request)
    points = _points(request, kind, problem)
    if kind == "multistart":
        base = {**base, "guess": base.get("guess", {"kind": "linear"})}
    _check_size(base, len(points))
    chunk = _chunk(request, kind, len(points), settings)
    seconds, megabytes = _budget(_checked(base, points), settings)
    return SweepPlan(
        name=request.name or problem.name,
        kind=kind,
        base=base,
        points=[point.values for point in points],
        axes=request.grid,
        chunk=chunk,
        warm=kind != "multistart" and request.warm is not False,
        seconds=seconds,
        megabytes=megabytes,
    )


def _request(document: Document) -> SweepRequest:
    try:
        return SweepRequest.model_validate(document)
    except ValidationError as error:
        found = [_issue(detail) for detail in error.errors(include_url=False)[:MAX_ISSUES]]
        raise BadProblem(found) from None


def _issue(detail: Any) -> Issue:
    place = pointer(*detail["loc"])
    if detail["type"] == "extra_forbidden":
        word, fields = str(detail["loc"][-1]), list(SweepRequest.model_fields)
        hint = did_you_mean(word, fields) or "the fields here are " + ", ".join(fields)
        return Issue(place, f"unknown field {quoted(word)}", hint)
    if detail["type"] == "missing":
        hint = "a sweep is {'problem': {...}, 'grid': {...}}; a problem alone goes to /v1/jobs"
        return Issue(place, "the field 'problem' is missing", hint)
    return Issue(place, detail["msg"].replace("Input should be", "expected", 1))


def _base(document: Document, inline: Callable[[Document], Document]) -> tuple[Document, Problem]:
    """The self-contained problem that all points change."""
    try:
        base = read_inlined(document, inline)
        return base, read_problem(base)
    except BadProblem as error:
        raise BadProblem(
            [_moved(issue, f"/problem{issue.pointer}") for issue in error.issues]
        ) from None


def _kind(request: SweepRequest) -> Kind:
    kinds: tuple[Kind, ...] = ("grid", "points", "multistart")
    given = [kind for kind in kinds if getattr(request, kind) is not None]
    if len(given) != 1:
        place = pointer(given[1]) if given else ""
        raise BadProblem([Issue(place, "a sweep goes over one thing", _ONE_OF)])
    if given[0] == "multistart" and request.warm:
        words = "guesses are independent of each other"
        raise BadProblem([Issue("/warm", words, "leave 'warm' out")])
    return given[0]


def _points(request: SweepRequest, kind: Kind, problem: Problem) -> list[_Point]:
    """The points, as many as may be."""
    if kind == "grid":
        count, made = _grid(request.grid or {})
    elif kind == "points":
        given = request.points or []
        count, made = len(given), (_listed(index, point) for index, point in enumerate(given))
    else:
        count = request.multistart or 0
        made = (_seeded(seed, problem) for seed in range(count))
    if count == 0:
        raise BadProblem([Issue(f"/{kind}", "there is no point in it", "name values to try")])
    if count > MODEL_LIMITS.sweep:
        words = f"over the limit 'sweep': {count} points, at most {MODEL_LIMITS.sweep}"
        raise BadProblem([Issue(f"/{kind}", words, "post several sweeps")])
    return list(made)


def _grid(axes: dict[str, list[Any]]) -> tuple[int, Iterator[_Point]]:
    count = math.prod(map(len, axes.values())) if axes else 0
    combinations = product(*(range(len(values)) for values in axes.values()))
    made = (
        _Point(
            {name: axes[name][at] for name, at in zip(axes, chosen, strict=True)},
            {name: pointer("grid", name, at) for name, at in zip(axes, chosen, strict=True)},
            "/grid",
        )
        for chosen in combinations
    )
    return count, made


def _listed(index: int, values: Values) -> _Point:
    places = {name: pointer("points", index, name) for name in values}
    return _Point(values, places, pointer("points", index))


def _seeded(number: int, problem: Problem) -> _Point:
    """The problem's own guess for the first, then the random ones that ``multistart`` tries too."""
    single = {"/multistart": 1} if problem.multistart > 1 else {}
    if number == 0:
        return _Point(single, {}, "/multistart")
    guesses = {
        pointer("phases", index, "guess"): _random(phase.guess, number)
        for index, phase in enumerate(problem.phases)
        if phase.guess is not None
    }
    values = {"/guess": _random(problem.guess, number), **guesses, **single}
    return _Point(values, {}, "/multistart")


def _random(guess: Guess, number: int) -> Document:
    """A random guess; its seed counts on from that of a guess that is random itself."""
    if isinstance(guess, RandomGuess):
        return guess.model_dump(mode="json", exclude_none=True) | {"seed": guess.seed + number}
    duration = getattr(guess, "duration", None)
    return {"kind": "random", "seed": number} | ({} if duration is None else {"duration": duration})


def _check_size(base: Document, count: int) -> None:
    size, most = _values(base), MODEL_LIMITS.sweep_values
    if size * count > most:
        words = f"over the limit 'sweep_values': {count} points of {size} values, at most {most}"
        raise BadProblem([Issue("", words, "take fewer points, or a guess with fewer segments")])


def _values(value: Any) -> int:
    if isinstance(value, dict):
        return 1 + sum(map(_values, value.values()))
    return 1 + sum(map(_values, value)) if isinstance(value, list) else 1


def _chunk(request: SweepRequest, kind: Kind, count: int, settings: ApiSettings) -> int:
    """Points of a job: as asked, or so that all jobs have about as many."""
    in_a_row = 1 if kind == "multistart" else _IN_A_ROW
    chunk = request.chunk or math.ceil(count / math.ceil(count / in_a_row))
    jobs, most = math.ceil(count / chunk), settings.max_waiting_jobs
    if jobs > most:
        words = f"{count} points make {jobs} jobs, but at most {most} of yours may wait"
        mend = f"let a job have {math.ceil(count / most)} points or more"
        raise BadProblem([Issue("/chunk", words, mend)])
    return chunk


def _checked(base: Document, points: list[_Point]) -> list[Limits]:
    """What each point asks for. Raises BadProblem with what is wrong with any of them."""
    asked: list[Limits] = []
    found: dict[tuple[str, str], Issue] = {}
    for index, point in enumerate(points):
        for issue in _wrong(base, index, point, asked):
            found.setdefault((issue.pointer, issue.message), issue)
        if len(found) >= MAX_ISSUES:
            break
    if found:
        raise BadProblem(list(islice(found.values(), MAX_ISSUES)))
    return asked


def _wrong(base: Document, index: int, point: _Point, asked: list[Limits]) -> Iterator[Issue]:
    for name in point.places:
        try:
            replaced(base, {name: None})
        except NoPlace as error:
            yield Issue(point.places[name], error.message, error.hint)
            return
    try:
        asked.append(read_problem(replaced(base, point.values)).limits)
    except BadProblem as error:
        yield from (_posted(issue, index, point) for issue in error.issues)


def _posted(issue: Issue, index: int, point: _Point) -> Issue:
    """The issue at the value that was posted, if it is about one; else at the point."""
    for name, place in point.places.items():
        if f"{issue.pointer}/".startswith(f"{name}/"):
            return _moved(issue, place + issue.pointer[len(name) :])
        if name.startswith(f"{issue.pointer}/") and issue.pointer:
            return _moved(issue, place)
    words = f"at point {index}, {issue.pointer or '/'}: {issue.message}"
    return Issue(point.place, words, issue.hint)


def _moved(issue: Issue, place: str) -> Issue:
    return Issue(place, issue.message, issue.hint, issue.column)


def _budget(asked: list[Limits], settings: ApiSettings) -> tuple[float, int]:
    """The most that a point may use, after the service's caps: seconds, megabytes."""
    seconds = max(limits.seconds for limits in asked)
    megabytes = max(limits.megabytes for limits in asked)
    return min(seconds, settings.max_seconds), min(megabytes, settings.max_megabytes)
