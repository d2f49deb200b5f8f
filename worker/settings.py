"""What a worker may be told, from parameters or from the environment of the moment."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from store import embedded


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerSettings:
    """Times in seconds.

    Parameters
    ----------
    url
        The queue server.
    name
        Unique among the living workers; made up if empty.
    ttl
        A worker that was silent for so long is dead, and its job goes to another.
    maintenance
        Between two sweeps for lost jobs.
    tick
        Between two looks at the process of a running job.
    kill_after
        From the wish to cancel to the kill of a solve that does not react.
    most_attempts
        A job that lost so many workers is failed: it may be what kills them.
    most_kills
        The same for processes killed under a living worker.
    """

    url: str
    name: str = ""
    ttl: float = 6.0
    maintenance: float = 3.0
    tick: float = 0.25
    kill_after: float = 1.0
    most_attempts: int = 3
    most_kills: int = 2


def server_url(environment: Mapping[str, str]) -> str:
    """``REDIS_URL``, or the embedded server of the folder ``FOOTFALL_DATA`` (``.footfall``)."""
    return environment.get("REDIS_URL") or embedded.url(
        Path(environment.get("FOOTFALL_DATA") or ".footfall")
    )
