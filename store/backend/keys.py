"""The names of all keys, in one place."""

import hashlib

LIVE = "footfall:live"
"""Set: the ids of all jobs that have not ended."""

WORKERS = "footfall:workers"
"""Set: the names of the workers, the dead ones until somebody looks."""

CHANGED = "footfall:changed"
"""Channel: the id of a job with a new event. Only a hint; the stream is the truth."""

FENCE = "footfall:fence"
"""A throw-away write, so that WAITAOF on any connection covers what was written before it."""


def record(job_id: str) -> str:
    """Hash: the job's record."""
    return f"footfall:job:{job_id}"


def problem(job_id: str) -> str:
    """The job's problem, compressed."""
    return f"footfall:job:{job_id}:problem"


def result(job_id: str) -> str:
    """The job's result, compressed."""
    return f"footfall:job:{job_id}:result"


def report(job_id: str) -> str:
    """The job's report, compressed."""
    return f"footfall:job:{job_id}:report"


def events(job_id: str) -> str:
    """Stream: the job's events."""
    return f"footfall:job:{job_id}:events"


def of_job(job_id: str) -> tuple[str, ...]:
    """Every key of one job."""
    return tuple(name(job_id) for name in (record, problem, result, report, events))


def sweep(sweep_id: str) -> str:
    """Hash: the sweep's record."""
    return f"footfall:sweep:{sweep_id}"


def sweep_plan(sweep_id: str) -> str:
    """The sweep's plan, compressed."""
    return f"footfall:sweep:{sweep_id}:plan"


def sweep_ended(sweep_id: str) -> str:
    """Hash: index of a point that has ended -> its outcome as JSON."""
    return f"footfall:sweep:{sweep_id}:ended"


def sweep_begun(sweep_id: str) -> str:
    """Hash: index of a point -> how often it was begun."""
    return f"footfall:sweep:{sweep_id}:begun"


def sweep_result(sweep_id: str, index: int) -> str:
    """The result of one point, compressed."""
    return f"footfall:sweep:{sweep_id}:result:{index}"


def of_sweep(sweep_id: str) -> tuple[str, ...]:
    """Every key of one sweep but those of its points' results."""
    return tuple(name(sweep_id) for name in (sweep, sweep_plan, sweep_ended, sweep_begun))


def sweeps_of(name: str) -> str:
    """Sorted set: an owner's sweep ids by the time of their creation."""
    return f"footfall:sweeps:{name}"


def owner(name: str) -> str:
    """Sorted set: an owner's job ids by the time of their creation."""
    return f"footfall:owner:{name}"


def worker(name: str) -> str:
    """What a living worker tells of itself; expires with it."""
    return f"footfall:worker:{name}"


def idempotency(owner_name: str, key: str) -> str:
    """One idempotency key of one owner. Hashed: clients choose the text."""
    digest = hashlib.sha256(f"{owner_name}\0{key}".encode()).hexdigest()
    return f"footfall:idempotency:{digest}"
