"""Every error that the client, the command and an in-process solve raise.

    FootfallError
    +-- BadFile              a file is missing, unreadable, or not the JSON it should be
    +-- BadProblem           the problem breaks the language; carries the issues
    +-- JobFailed            the job ended without a result, and says why
    +-- WaitTimeout          the job did not end in time; it goes on
    +-- EngineFault          the engine failed in-process: a bug, or a dead solver
    +-- MissingServer        this call needs the server packages, which are not installed
    +-- ServeFailed          the service could not be started here
    +-- ConnectionFailed     no service answered
    |   +-- ConnectionTimeout    not within the time allowed
    +-- BadReply             what answered is not a Footfall service, or broke off
    +-- Refused              the service refused, and said why
        +-- Unauthorized     a known key is needed
        +-- UnknownJob       no such job, or somebody else's
        +-- UnknownSweep     no such sweep, or somebody else's
        +-- ResultNotReady   the job has not ended
        +-- NoResult         the job ended and will never have a result
        +-- ResultExpired    the result was there and has expired
        +-- Conflict         the request does not fit the job's state, or an idempotency key
        +-- BodyTooLarge     the problem is over the published size
        +-- TryLater         too many requests, or no room now; says when to retry
        +-- ServiceFault     the service met a bug

``HTTPX_ERRORS`` maps every exception of httpx, ``PROBLEM_ERRORS`` every type of
``application/problem+json`` that needs a class of its own.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import httpx


class FootfallError(Exception):
    """The root of the tree. ``hint`` says how to mend it."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(f"{message}\n{hint}" if hint else message)
        self.message = message
        self.hint = hint


@dataclass(frozen=True, slots=True)
class Issue:
    """One thing wrong with a problem.

    ``pointer`` is a JSON pointer (RFC 6901) into the problem; ``column`` counts from 1 in the
    user's own expression.
    """

    pointer: str
    message: str
    hint: str = ""
    column: int | None = None

    def __str__(self) -> str:
        column = f", column {self.column}" if self.column is not None else ""
        hint = f" Hint: {self.hint}" if self.hint else ""
        return f"{self.pointer or '/'}{column}: {self.message}{hint}"


class BadFile(FootfallError):
    """A file is missing, unreadable, or not the JSON it should be."""


class BadProblem(FootfallError):
    """The problem breaks the language, or its model cannot be built."""

    def __init__(self, issues: list[Issue]) -> None:
        super().__init__("\n".join(str(issue) for issue in issues) or "The problem is refused.")
        self.issues = issues


class JobFailed(FootfallError):
    """The job ended without a result."""


class WaitTimeout(FootfallError):
    """The job did not end in time. It goes on; wait again or cancel it."""


class EngineFault(FootfallError):
    """The engine failed in-process: a bug, or a crash of the solver."""


class MissingServer(FootfallError):
    """This call needs the server packages."""


class ServeFailed(FootfallError):
    """The service could not be started on this machine."""


class ConnectionFailed(FootfallError):
    """No service answered at the address."""


class ConnectionTimeout(ConnectionFailed):
    """The service did not answer within the time allowed."""


class BadReply(FootfallError):
    """What answered is not a Footfall service, or broke off."""


class Refused(FootfallError):
    """The service refused and said why: ``status`` of HTTP and the type's ``code``."""

    def __init__(self, message: str, hint: str = "", *, status: int = 0, code: str = "") -> None:
        super().__init__(message, hint)
        self.status = status
        self.code = code


class Unauthorized(Refused):
    """The service wants a known key: ``Client(url, key=...)`` or FOOTFALL_KEY."""


class UnknownJob(Refused):
    """There is no such job for this key."""


class UnknownSweep(Refused):
    """There is no such sweep for this key, or no such point of it."""


class ResultNotReady(Refused):
    """The job has not ended and has no iterate yet."""


class NoResult(Refused):
    """The job ended without an iterate; there never will be a result."""


class ResultExpired(Refused):
    """The result was kept for its time and is gone."""


class Conflict(Refused):
    """The request does not fit the state of the job or of an idempotency key."""


class BodyTooLarge(Refused):
    """The problem is larger than the service takes."""


class TryLater(Refused):
    """Too many requests, or no room now. ``retry_after`` is in seconds, where told."""

    retry_after: float | None = None


class ServiceFault(Refused):
    """The service met a bug; its log has the story."""


HTTPX_ERRORS: dict[type[Exception], type[FootfallError]] = {
    httpx.TimeoutException: ConnectionTimeout,
    httpx.NetworkError: ConnectionFailed,
    httpx.ProxyError: ConnectionFailed,
    httpx.UnsupportedProtocol: ConnectionFailed,
    httpx.ProtocolError: BadReply,
    httpx.DecodingError: BadReply,
    httpx.TooManyRedirects: BadReply,
    httpx.HTTPStatusError: BadReply,
    httpx.TransportError: ConnectionFailed,
    httpx.RequestError: ConnectionFailed,
    httpx.HTTPError: BadReply,
    httpx.InvalidURL: ConnectionFailed,
    httpx.CookieConflict: BadReply,
    httpx.StreamError: BadReply,
}

PROBLEM_ERRORS: dict[str, type[Refused]] = {
    "unauthorized": Unauthorized,
    "unknown-job": UnknownJob,
    "unknown-sweep": UnknownSweep,
    "result-not-ready": ResultNotReady,
    "no-result": NoResult,
    "result-expired": ResultExpired,
    "conflict": Conflict,
    "key-reused": Conflict,
    "body-too-large": BodyTooLarge,
    "queue-full": TryLater,
    "store-unavailable": TryLater,
    "rate-limited": TryLater,
    "not-ready": TryLater,
    "engine-fault": ServiceFault,
    "internal-error": ServiceFault,
}

_ISSUES = frozenset({"bad-problem", "invalid-model"})


def from_httpx(error: Exception, url: str) -> FootfallError:
    """Our error for one of httpx's; the nearest class of the table decides."""
    kind = next(HTTPX_ERRORS[cls] for cls in type(error).__mro__ if cls in HTTPX_ERRORS)
    words = str(error) or type(error).__name__
    if isinstance(error, httpx.UnsupportedProtocol | httpx.InvalidURL):
        return kind(f"{url} is not the address of a service.", "Write http://HOST:PORT.")
    if issubclass(kind, ConnectionFailed):
        hint = "Is the service running? 'footfall serve' starts one; --server says where it is."
        return kind(f"No service answered at {url}: {words}", hint)
    return kind(f"The reply from {url} cannot be used: {words}")


def from_problem(status: int, document: Mapping[str, Any], url: str) -> FootfallError:
    """Our error for an ``application/problem+json`` reply (RFC 9457)."""
    code = str(document.get("type", "")).rsplit("/", 1)[-1]
    if code in _ISSUES:
        return BadProblem(read_issues(document.get("errors") or []) or [_whole(document)])
    kind = PROBLEM_ERRORS.get(code, ServiceFault if status >= 500 else Refused)
    words = document.get("detail") or document.get("title")
    words = words or f"The service at {url} answered {status} and gave no reason."
    return kind(str(words), str(document.get("hint") or ""), status=status, code=code)


def read_issues(items: list[Any]) -> list[Issue]:
    """Issues out of the ``errors`` of a reply, or the ``issues`` of a failed job."""
    return [
        Issue(
            pointer=str(item.get("pointer") or ""),
            message=str(item.get("message") or ""),
            hint=str(item.get("hint") or ""),
            column=item.get("column"),
        )
        for item in items
    ]


def _whole(document: Mapping[str, Any]) -> Issue:
    detail = document.get("detail") or document.get("title") or "The problem is refused."
    return Issue("", str(detail), str(document.get("hint") or ""))
