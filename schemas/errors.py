"""Every error of Footfall that a client may meet, and what HTTP makes of it.

    FootfallError
    +-- BadProblem          the problem breaks the language; carries the issues
    +-- InvalidModel        only the model could tell (found by the worker)
    +-- EngineFault         the engine itself failed; a bug or a dead solver
    +-- UnknownJob          no such job, or somebody else's
    +-- UnknownSweep        no such sweep, or somebody else's
    +-- ResultNotReady      the job has not ended
    +-- NoResult            the job ended and will never have a result
    +-- ResultExpired       the result was there and has expired
    +-- BodyTooLarge        the request's body is over the limit
    +-- Conflict            the request does not fit the job's state, or an idempotency key
    +-- QueueFull           too many jobs wait; retry later
    +-- StoreUnavailable    Redis is away; retry later
    +-- RateLimited         too many requests from one owner; retry later
    +-- Unauthorized        keys are on, and the request has none that is known

``PROBLEM_TYPES`` maps each class to its stable code, HTTP status and title.
"""

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Issue:
    """One thing wrong with a problem: where, what, and the mend.

    ``pointer`` is a JSON pointer (RFC 6901) into the posted problem; ``column`` counts from 1 in
    the user's own text, for expressions.
    """

    pointer: str
    message: str
    hint: str = ""
    column: int | None = None

    def __str__(self) -> str:
        column = f", column {self.column}" if self.column is not None else ""
        hint = f" Hint: {self.hint}" if self.hint else ""
        return f"{self.pointer or '/'}{column}: {self.message}{hint}"


class FootfallError(Exception):
    """The root of the tree. ``hint`` says how to mend it."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint


class BadProblem(FootfallError):
    """The problem breaks the language. ``issues`` names every place, reason and mend."""

    def __init__(self, issues: list[Issue]) -> None:
        super().__init__("\n".join(str(issue) for issue in issues))
        self.issues = issues


class InvalidModel(BadProblem):
    """What only the built model can tell, such as a dynamics that is NaN at the guess."""


class EngineFault(FootfallError):
    """The engine failed where it should not have: a bug, or a crash in native code."""


class UnknownJob(FootfallError):
    """No such job for this owner."""


class UnknownSweep(FootfallError):
    """No such sweep for this owner, or no such point of it."""


class ResultNotReady(FootfallError):
    """The job is still queued or running and has no iterate yet."""


class NoResult(FootfallError):
    """The job has ended without an iterate; there never will be a result."""


class ResultExpired(FootfallError):
    """The result was kept for its time and is gone."""


class BodyTooLarge(FootfallError):
    """The request's body is over the published limit."""


class Conflict(FootfallError):
    """The request does not fit the state of the job or of an idempotency key."""


class QueueFull(FootfallError):
    """As many jobs wait as the service allows."""


class StoreUnavailable(FootfallError):
    """The queue server does not answer."""


class RateLimited(FootfallError):
    """This owner sends more than its share."""


class Unauthorized(FootfallError):
    """Keys are on and the request carries none that is known."""


@dataclass(frozen=True, slots=True)
class ProblemType:
    """How a class of errors looks over HTTP (RFC 9457)."""

    code: str
    status: int
    title: str
    retry_after: int | None = field(default=None)


PROBLEM_TYPES: dict[type[FootfallError], ProblemType] = {
    BadProblem: ProblemType("bad-problem", 422, "The problem breaks the language"),
    InvalidModel: ProblemType("invalid-model", 422, "The model cannot be built or evaluated"),
    EngineFault: ProblemType("engine-fault", 500, "The engine failed"),
    UnknownJob: ProblemType("unknown-job", 404, "There is no such job"),
    UnknownSweep: ProblemType("unknown-sweep", 404, "There is no such sweep"),
    ResultNotReady: ProblemType("result-not-ready", 409, "The result is not ready", 1),
    NoResult: ProblemType("no-result", 404, "The job ended without a result"),
    ResultExpired: ProblemType("result-expired", 410, "The result has expired"),
    BodyTooLarge: ProblemType("body-too-large", 413, "The body is too large"),
    Conflict: ProblemType("conflict", 409, "The request does not fit the current state"),
    QueueFull: ProblemType("queue-full", 503, "The queue is full", 10),
    StoreUnavailable: ProblemType("store-unavailable", 503, "The queue server is away", 5),
    RateLimited: ProblemType("rate-limited", 429, "Too many requests", 5),
    Unauthorized: ProblemType("unauthorized", 401, "A known key is needed"),
}
