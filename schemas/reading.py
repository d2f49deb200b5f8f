"""Reading a problem: JSON, then its shape, then its meaning; and writing it canonically."""

import hashlib
from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from typing import Any

import orjson
from pydantic import ValidationError

from schemas import stages
from schemas.base import Posted
from schemas.checks import check
from schemas.complaints import issue_of
from schemas.errors import BadProblem, Issue
from schemas.json_text import decode, faults
from schemas.problem import Problem

MAX_ISSUES = 50

_ORDERED = frozenset({"parameters", "define"})
"""Objects whose order has a meaning: an entry may use those before it."""


_OF_PROBLEMS = ("phases", "objective", "time")
"""Fields of problems: who gives one beside a system has left out the phase around it."""

_ROUTE = {"problem": "/v1/jobs", "simulation": "/v1/simulations"}
_COMMAND = {"problem": "solve", "simulation": "simulate"}

Document = dict[str, Any]


def read_problem(
    data: bytes | str | Document, inline: Callable[[Document], Document] | None = None
) -> Problem:
    """Read and check a problem.

    Parameters
    ----------
    data
        JSON, as bytes in UTF-8 or as text, or what ``json.loads`` made of it.
    inline
        Puts in what the document only names (``schemas.inlining``); the same object if nothing.

    Raises
    ------
    BadProblem
        With every issue found by the first step that found any: JSON, shape, meaning, stages.
        Nothing else is raised, whatever the data; at most `MAX_ISSUES` issues are kept.
    """
    document = read_document(data)
    refuse(misdirected(document, "problem"))
    if inline is not None:
        document = read_inlined(document, inline)
    problem = _checked(document)
    refuse(stages.out_of_place(problem))
    refuse(_of_stages(problem))
    return problem


def read_document(data: bytes | str | Document, kind: str = "problem") -> Document:
    """The JSON object, without NaN, repeated keys or too much of anything. Raises BadProblem."""
    document: Any = data
    if isinstance(data, bytes | str):
        document, unreadable = decode(data)
        if unreadable is not None:
            raise BadProblem([unreadable])
    refuse(faults(document))
    if not isinstance(document, dict):
        raise BadProblem([Issue("", f"a {kind} is a JSON object, {{...}}")])
    return document


def misdirected(document: Document, kind: str) -> Iterator[Issue]:
    """A document of another kind than this one: a problem has phases, a simulation a system."""
    given = kind
    if "phases" in document and "system" not in document:
        given = "problem"
    elif "system" in document and document.keys().isdisjoint(_OF_PROBLEMS):
        given = "simulation"
    if given != kind:
        hint = f"send it to POST {_ROUTE[given]}; at a command line: footfall {_COMMAND[given]}"
        yield Issue("", f"this is a {given}, not a {kind}", hint)


def read_inlined(document: Document, inline: Callable[[Document], Document]) -> Document:
    """The document with what it names put in; still not too much of anything. BadProblem."""
    whole = inline(document)
    if whole is not document:
        refuse(faults(whole))
    return whole


def canonical(document: Posted) -> bytes:
    """A problem or simulation as JSON in one fixed order, defaults filled in, without ``known``.

    Reading it gives the document back: keys are sorted except where their order has a meaning.
    """
    return orjson.dumps(_sorted(document.model_dump(mode="json", exclude={"known"})))


def written(document: Posted) -> bytes:
    """The same in the order in which it was posted, as it is stored and solved.

    Where there are several minima, the order of bodies and joints may lead to another one.
    """
    return orjson.dumps(document.model_dump(mode="json", exclude={"known"}))


def spec_sha256(document: Posted) -> str:
    """The hash of the canonical document, 64 hexadecimal digits."""
    return hashlib.sha256(canonical(document)).hexdigest()


def _checked(document: dict[str, Any]) -> Problem:
    """The problem of good shape and meaning, its stages aside."""
    try:
        problem = Problem.model_validate(document)
    except ValidationError as error:
        details = error.errors(include_url=False)
        raise BadProblem([issue_of(detail) for detail in details[:MAX_ISSUES]]) from None
    refuse(check(problem))
    return problem


def _of_stages(problem: Problem) -> Iterator[Issue]:
    """What is wrong with the problems that the stages make, up to the first that is wrong."""
    for index, patch in enumerate(problem.stages):
        try:
            _checked(stages.stage_document(problem, index))
        except BadProblem as bad:
            yield from (stages.blamed(issue, index, patch) for issue in bad.issues)
            return


def refuse(issues: Iterable[Issue]) -> None:
    """Raise `BadProblem` where there are issues, with the first `MAX_ISSUES` of them."""
    found = list(islice(issues, MAX_ISSUES))
    if found:
        raise BadProblem(found)


def _sorted(value: Any, key: str = "") -> Any:
    if isinstance(value, list):
        return [_sorted(item) for item in value]
    if not isinstance(value, dict):
        return value
    items = value.items() if key in _ORDERED else sorted(value.items())
    return {name: _sorted(item, name) for name, item in items}
