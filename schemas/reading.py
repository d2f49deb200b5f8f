"""Reading a problem: JSON, then its shape, then its meaning; and writing it canonically."""

import hashlib
from collections.abc import Iterable
from itertools import islice
from typing import Any

import orjson
from pydantic import ValidationError

from schemas.checks import check
from schemas.complaints import issue_of
from schemas.errors import BadProblem, Issue
from schemas.json_text import decode, faults
from schemas.problem import Problem

MAX_ISSUES = 50

_ORDERED = frozenset({"parameters", "define"})
"""Objects whose order has a meaning: an entry may use those before it."""


def read_problem(data: bytes | str | dict[str, Any]) -> Problem:
    """Read and check a problem.

    Parameters
    ----------
    data
        JSON, as bytes in UTF-8 or as text, or what ``json.loads`` made of it.

    Raises
    ------
    BadProblem
        With every issue found by the first stage that found any: JSON, shape, meaning. Nothing
        else is raised, whatever the data; at most `MAX_ISSUES` issues are kept.
    """
    document: Any = data
    if isinstance(data, bytes | str):
        document, unreadable = decode(data)
        if unreadable is not None:
            raise BadProblem([unreadable])
    _refuse(faults(document))
    if not isinstance(document, dict):
        raise BadProblem([Issue("", "a problem is a JSON object, {...}")])
    try:
        problem = Problem.model_validate(document)
    except ValidationError as error:
        details = error.errors(include_url=False)
        raise BadProblem([issue_of(detail) for detail in details[:MAX_ISSUES]]) from None
    _refuse(check(problem))
    return problem


def canonical(problem: Problem) -> bytes:
    """The problem as JSON in one fixed order, defaults filled in, ``known`` left out.

    Reading it gives the problem back: keys are sorted except where their order has a meaning.
    """
    return orjson.dumps(_sorted(problem.model_dump(mode="json", exclude={"known"})))


def spec_sha256(problem: Problem) -> str:
    """The hash of the canonical problem, 64 hexadecimal digits."""
    return hashlib.sha256(canonical(problem)).hexdigest()


def _refuse(issues: Iterable[Issue]) -> None:
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
