"""Errors as ``application/problem+json`` (RFC 9457), each with a stable, relative ``type``."""

from typing import Any

from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel, Field
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect

from api.errors import TYPES, BadParameter, NoRoute, OtherRefusal, WrongMethod
from schemas.errors import BadProblem, FootfallError, ProblemType

MEDIA_TYPE = "application/problem+json"


class ErrorItem(BaseModel):
    """One thing wrong: in the posted document (``pointer``) or beside it (``parameter``)."""

    pointer: str = Field(
        default="", description="JSON pointer (RFC 6901) into the posted document."
    )
    parameter: str | None = Field(default=None, description="The query parameter or header.")
    column: int | None = Field(default=None, description="In the expression's text, from 1.")
    message: str
    hint: str = ""


class ProblemDetail(BaseModel):
    """What every error looks like."""

    type: str = Field(description="Stable and relative, such as /problems/bad-problem.")
    title: str
    status: int
    detail: str
    hint: str = ""
    errors: list[ErrorItem] = Field(default_factory=list)


def problem_type(error: FootfallError) -> ProblemType:
    """The nearest entry of the table for an error's class."""
    return next(TYPES[cls] for cls in type(error).__mro__ if cls in TYPES)


def problem_response(error: FootfallError, headers: dict[str, str] | None = None) -> Response:
    """The reply for an error; ``headers`` are added to those its type calls for."""
    kind = problem_type(error)
    errors = _errors(error)
    detail = ProblemDetail(
        type=f"/problems/{kind.code}",
        title=kind.title,
        status=kind.status,
        detail=_detail(error),
        hint=error.hint,
        errors=errors,
    )
    return _reply(detail, kind, headers)


def install(app: FastAPI) -> None:
    """Route every error of the app through this module."""
    app.exception_handler(FootfallError)(_footfall)
    app.exception_handler(HTTPException)(_http)
    app.exception_handler(RequestValidationError)(_validation)
    app.exception_handler(ClientDisconnect)(_gone)


def _errors(error: FootfallError) -> list[ErrorItem]:
    if isinstance(error, BadProblem):
        return [
            ErrorItem(pointer=i.pointer, column=i.column, message=i.message, hint=i.hint)
            for i in error.issues
        ]
    if isinstance(error, BadParameter) and error.parameter:
        return [ErrorItem(parameter=error.parameter, message=error.message, hint=error.hint)]
    return []


def _detail(error: FootfallError) -> str:
    if isinstance(error, BadProblem):
        count = len(error.issues)
        first = f"{error.issues[0]}" if error.issues else ""
        return first if count == 1 else f"{count} errors; the first: {first}"
    return error.message


def _reply(detail: ProblemDetail, kind: ProblemType, headers: dict[str, str] | None) -> Response:
    extra = dict(headers or {})
    if kind.retry_after is not None:
        extra.setdefault("Retry-After", str(kind.retry_after))
    if kind.status == 401:
        extra.setdefault("WWW-Authenticate", 'Bearer realm="footfall"')
    content = detail.model_dump_json(exclude_none=True).encode(errors="replace")
    return Response(content, kind.status, extra, MEDIA_TYPE)


async def _footfall(_: Request, error: FootfallError) -> Response:
    return problem_response(error)


async def _http(request: Request, error: HTTPException) -> Response:
    headers = dict(error.headers or {})
    if error.status_code == 404:
        hint = "GET /openapi.json lists every path."
        return problem_response(NoRoute("Nothing is served at this path.", hint), headers)
    if error.status_code == 405:
        headers["Allow"] = _allowed(request) or headers.get("Allow", "GET")
        words = f"{ascii(request.method)[1:-1]} is not known here; {headers['Allow']} may be."
        return problem_response(WrongMethod(words), headers)
    return problem_response(OtherRefusal(error.detail), headers)


def _allowed(request: Request) -> str:
    """Every method of the path: the router names only those of the first route that fits."""
    template = getattr(request.scope.get("route"), "path", "")
    methods = [method.upper() for method in request.app.openapi()["paths"].get(template, {})]
    return ", ".join(sorted(methods + ["HEAD"] * ("GET" in methods)))


async def _validation(_: Request, error: RequestValidationError) -> Response:
    items = [_item(raw) for raw in error.errors()]
    kind = TYPES[BadParameter]
    words = "; ".join(f"{item.parameter or 'body'}: {item.message}" for item in items)
    detail = ProblemDetail(
        type=f"/problems/{kind.code}",
        title=kind.title,
        status=kind.status,
        detail=words,
        errors=items,
    )
    return _reply(detail, kind, None)


def _item(raw: dict[str, Any]) -> ErrorItem:
    return ErrorItem(parameter=".".join(str(part) for part in raw["loc"][1:]), message=raw["msg"])


async def _gone(_: Request, __: ClientDisconnect) -> Response:
    """Nobody reads this: the client left before its body was whole. It keeps the log honest."""
    return problem_response(OtherRefusal("The client went away."))
