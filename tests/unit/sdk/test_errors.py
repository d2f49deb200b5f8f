"""Every foreign error has one of ours, and every refusal of the service its class."""

import inspect

import httpx
import pytest

from api.errors import TYPES
from footfall import errors
from footfall.errors import (
    HTTPX_ERRORS,
    BadProblem,
    FootfallError,
    Refused,
    from_httpx,
    from_problem,
)
from schemas.errors import BadProblem as ServerBadProblem
from schemas.errors import ProblemType

OURS = [
    cls
    for _, cls in inspect.getmembers(errors, inspect.isclass)
    if issubclass(cls, FootfallError) and cls.__module__ == errors.__name__
]
FOREIGN = [
    cls
    for name in httpx.__all__
    if inspect.isclass(cls := getattr(httpx, name)) and issubclass(cls, Exception)
]


@pytest.mark.parametrize("cls", FOREIGN, ids=lambda cls: cls.__name__)
def test_every_exception_of_httpx_is_mapped(cls: type[Exception]) -> None:
    assert any(parent in HTTPX_ERRORS for parent in cls.__mro__)


def test_httpx_errors_become_ours_with_a_mend() -> None:
    error = from_httpx(httpx.ConnectError("refused"), "http://here")
    assert type(error) is errors.ConnectionFailed
    assert "http://here" in error.message
    assert "footfall serve" in error.hint
    assert type(from_httpx(httpx.ReadTimeout("late"), "x")) is errors.ConnectionTimeout
    assert type(from_httpx(httpx.RemoteProtocolError("cut"), "x")) is errors.BadReply


@pytest.mark.parametrize("kind", TYPES.values(), ids=lambda kind: kind.code)
def test_every_problem_type_of_the_service_is_understood(kind: ProblemType) -> None:
    code, status = kind.code, kind.status
    document = {"type": f"/problems/{code}", "detail": "why", "hint": "mend", "status": status}
    error = from_problem(status, document, "x")
    assert "why" in str(error)
    assert "mend" in str(error)
    if not isinstance(error, BadProblem):
        assert isinstance(error, Refused)
        assert (error.code, error.status) == (code, status)
        assert isinstance(error, errors.ServiceFault) == (status == 500)
        assert isinstance(error, errors.TryLater) == (status in {429, 503})


def test_the_table_names_only_types_that_the_service_has() -> None:
    known = {kind.code for kind in TYPES.values()}
    assert set(errors.PROBLEM_ERRORS) <= known
    assert TYPES[ServerBadProblem].code in known


def test_issues_keep_pointer_column_and_hint() -> None:
    item = {
        "pointer": "/a/b",
        "column": 3,
        "message": "unknown name 'x'",
        "hint": "did you mean 'y'?",
    }
    error = from_problem(422, {"type": "/problems/bad-problem", "errors": [item]}, "x")
    assert isinstance(error, BadProblem)
    assert str(error) == "/a/b, column 3: unknown name 'x' Hint: did you mean 'y'?"


def test_a_refusal_without_a_type_still_speaks() -> None:
    assert "answered 418" in str(from_problem(418, {}, "http://here"))


@pytest.mark.parametrize("cls", OURS, ids=lambda cls: cls.__name__)
def test_the_drawn_tree_names_every_class(cls: type[FootfallError]) -> None:
    assert f"{cls.__name__} " in (errors.__doc__ or "") or cls is FootfallError
    assert inspect.getdoc(cls)
