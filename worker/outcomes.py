"""How an attempt ended, and what errors look like in the job's record."""

import logging
from dataclasses import dataclass
from typing import Generic, Never, TypeVar

from rq.timeouts import JobTimeoutException

from schemas.errors import PROBLEM_TYPES, BadProblem, EngineFault, FootfallError
from schemas.jobs import JobError, JobIssue, JobStatus
from schemas.results import Solution, SolutionStatus
from schemas.simulated import SimulationResult, SimulationStatus

logger = logging.getLogger("footfall.worker")
_LONGEST = 300

_STOPPED = (SolutionStatus.CANCELLED, SimulationStatus.CANCELLED)

Finished = Solution | SimulationResult
R = TypeVar("R", bound=Finished)
R_co = TypeVar("R_co", bound=Finished, covariant=True)

OUT_OF_MEMORY = "out-of-memory"
OUT_OF_TIME = "out-of-time"
WORKER_KILLED = "worker-killed"


@dataclass(frozen=True, slots=True)
class Outcome(Generic[R_co]):
    """The end of an attempt: a state, and the result or the error."""

    to: JobStatus
    result: R_co | None = None
    error: JobError | None = None


def finished(result: R) -> Outcome[R]:
    """The engine finished, however the mathematics ended; or it was asked to stop."""
    cancelled = result.status in _STOPPED
    return Outcome(JobStatus.CANCELLED if cancelled else JobStatus.SUCCEEDED, result=result)


def failed(error: Exception, job_id: str) -> Outcome[Never]:
    """What the record says of an exception; a trace goes to the log alone."""
    if isinstance(error, BadProblem):
        return Outcome(JobStatus.FAILED, error=_bad_problem(error))
    if _is_memory(error):
        logger.warning("job %s ran out of memory", job_id)
        return Outcome(JobStatus.FAILED, error=out_of_memory())
    if isinstance(error, JobTimeoutException):
        logger.warning("job %s overran its time limit in native code", job_id)
        return Outcome(JobStatus.FAILED, error=out_of_time())
    logger.error("job %s: the engine failed", job_id, exc_info=error)
    words = (
        error.message if isinstance(error, FootfallError) else f"{type(error).__name__}: {error}"
    )
    hint = error.hint if isinstance(error, FootfallError) else ""
    described = JobError(
        type=PROBLEM_TYPES[EngineFault].code,
        message=(words.splitlines() or [""])[0][:_LONGEST],
        hint=hint or "This is a fault of the engine. Please report it with the problem.",
    )
    return Outcome(JobStatus.FAILED, error=described)


def out_of_memory() -> JobError:
    """The job asked for more memory than it may have."""
    return JobError(
        type=OUT_OF_MEMORY,
        message="The job needs more memory than limits.megabytes allows.",
        hint="Raise limits.megabytes, or use fewer segments or samples.",
    )


def out_of_time() -> JobError:
    """The job overran its budget where its own deadline is not asked."""
    return JobError(
        type=OUT_OF_TIME,
        message="The job overran limits.seconds without reaching a result.",
        hint="Raise limits.seconds, or use fewer segments or larger steps.",
    )


def worker_killed(attempts: int, how: str) -> JobError:
    """The job took its process or its worker along too often."""
    return JobError(
        type=WORKER_KILLED,
        message=f"After {attempts} attempts the job is given up: {how}.",
        hint="It may need more memory than the machine has; try fewer segments.",
    )


def _bad_problem(error: BadProblem) -> JobError:
    issues = [
        JobIssue(pointer=issue.pointer, message=issue.message, hint=issue.hint, column=issue.column)
        for issue in error.issues
    ]
    first = error.issues[0] if error.issues else None
    return JobError(
        type=PROBLEM_TYPES[type(error)].code,
        message=str(first) if first else "The problem breaks the language.",
        hint=first.hint if first else "",
        issues=issues,
    )


def _is_memory(error: Exception) -> bool:
    """Native code tells of failed allocations in words only."""
    return isinstance(error, MemoryError) or "bad_alloc" in str(error)
