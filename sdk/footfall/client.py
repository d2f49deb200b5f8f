"""The client of a Footfall service."""

import io
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields
from typing import Any, Self

import httpx
import numpy as np

from footfall.curves import Floats
from footfall.documents import Problem, is_simulation, read_problem
from footfall.errors import (
    BadProblem,
    BadReply,
    ConnectionFailed,
    Issue,
    JobFailed,
    UnknownJob,
    WaitTimeout,
    read_issues,
)
from footfall.result import Result, read_result
from footfall.sse import Event, parse
from footfall.sweeps import SweepCalls
from footfall.transport import Retries, Transport, encoded

DEFAULT_URL = "http://127.0.0.1:8000"

_JSON = {"Content-Type": "application/json"}
_ENDED = frozenset({"succeeded", "failed", "cancelled", "expired"})
_LONG_POLL = 20  # seconds; the service holds a poll for 60 at the most
_SILENCE = 45.0  # seconds without even a comment, after which a stream is taken for dead


@dataclass(frozen=True, slots=True)
class Job:
    """A job as the service last told. ``document`` is its whole JSON."""

    id: str
    name: str
    status: str
    solution_status: str | None = None
    message: str = ""
    attempts: int = 0
    queue_position: int | None = None
    progress: dict[str, Any] | None = None
    timings: dict[str, float | None] = field(default_factory=dict)
    error: dict[str, Any] | None = None
    kind: str = "solve"
    links: dict[str, str] = field(default_factory=dict)
    document: dict[str, Any] = field(default_factory=dict, repr=False)

    @property
    def ended(self) -> bool:
        """Whether the job is succeeded, failed, cancelled or expired."""
        return self.status in _ENDED

    @classmethod
    def read(cls, document: dict[str, Any]) -> "Job":
        """A job out of its JSON."""
        names = {item.name for item in fields(cls)} - {"document"}
        try:
            return cls(**{n: document[n] for n in names if n in document}, document=document)
        except TypeError as error:
            raise BadReply("The service answered with something that is no job.") from error


class Client(SweepCalls):
    """Talks to a service: submit problems and simulations, follow jobs, fetch results.

    A connection that breaks is tried again, as is a reply of 429 or 503; a submission carries an
    idempotency key, so that trying again never makes a second job.

    Parameters
    ----------
    url : str
        Where the service is.
    key : str, optional
        The bearer key, where the service asks for one.
    timeout : float
        Seconds that one answer may take.
    retries : Retries
        How often and how long to try again.
    transport : httpx.BaseTransport, optional
        Another way to the service, such as an app in the same process.

    Examples
    --------
    >>> with Client() as client:  # doctest: +SKIP
    ...     job = client.submit("examples/cart_pole.json")
    ...     result = client.wait(job.id)
    ...     result["q1"](0.5)
    """

    def __init__(
        self,
        url: str = DEFAULT_URL,
        key: str | None = None,
        *,
        timeout: float = 30.0,
        retries: Retries | None = None,
        transport: httpx.BaseTransport | None = None,
    ) -> None:
        headers = {"Authorization": f"Bearer {key}"} if key else {}
        self.url = url.rstrip("/").removesuffix("/v1")  # some will name the versioned path
        http = httpx.Client(
            base_url=self.url, headers=headers, timeout=timeout, transport=transport
        )
        self._timeout = timeout
        self._transport = Transport(http, retries or Retries())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the connections."""
        self._transport.http.close()

    def submit(self, problem: Problem, *, idempotency_key: str | None = None) -> Job:
        """Queue a problem: a dict, or the path of a JSON file.

        ``idempotency_key`` is made up unless given; the same key never makes a second job.
        Raises ``BadProblem`` with every issue.
        """
        body = encoded(read_problem(problem))
        return Job.read(self._transport.post_once("/v1/jobs", body, idempotency_key))

    def simulate(self, simulation: Problem, *, idempotency_key: str | None = None) -> Job:
        """Queue a simulation: a dict, or the path of a JSON file. The rest is as for problems.

        ``wait`` then gives a ``SimulationResult``. Raises ``BadProblem`` with every issue.
        """
        body = encoded(read_problem(simulation))
        return Job.read(self._transport.post_once("/v1/simulations", body, idempotency_key))

    def validate(self, problem: Problem) -> list[Issue]:
        """What is wrong with a problem or simulation; nothing is stored. Empty: it is fine."""
        return self.check(problem)[0]

    def check(self, problem: Problem) -> tuple[list[Issue], list[str]]:
        """What is wrong with a problem or simulation; and warnings about one that is fine."""
        query = {"validate_only": "true"}
        document = read_problem(problem)
        path = "/v1/simulations" if is_simulation(document) else "/v1/jobs"
        try:
            body = encoded(document)
            said = self._transport.json("POST", path, content=body, headers=_JSON, params=query)
        except BadProblem as error:
            return error.issues, []
        return [], list(said.get("warnings", []))

    def job(self, job_id: str) -> Job:
        """How a job is doing."""
        return self._job("GET", f"/v1/jobs/{job_id}")

    def jobs(
        self, *, status: str | None = None, name: str | None = None, kind: str | None = None
    ) -> Iterator[Job]:
        """Your jobs, newest first, page by page as you go on; of a kind "solve", "simulation"."""
        asked = {"status": status, "name": name, "kind": kind}
        query = {key: value for key, value in asked.items() if value}
        while True:
            page = self._transport.json("GET", "/v1/jobs", params=query)
            yield from map(Job.read, page["jobs"])
            if not page.get("next"):
                return
            query["cursor"] = page["next"]

    def wait(
        self,
        job_id: str,
        *,
        timeout: float | None = None,
        on_event: Callable[[Event], object] | None = None,
    ) -> Result:
        """The result of a job once it has ended, however the mathematics ended.

        Parameters
        ----------
        timeout : float, optional
            Seconds to wait at the most.
        on_event : callable, optional
            Is called with each event as it comes.

        Raises
        ------
        WaitTimeout
            If the job has not ended in time; it goes on.
        BadProblem, JobFailed
            If the job ended without a result.
        """
        deadline = None if timeout is None else time.monotonic() + timeout
        if on_event is not None:
            for event in self.events(job_id, timeout=timeout):
                on_event(event)
        job = self.job(job_id)
        while not job.ended:
            left = _left(deadline, job_id)
            query = {"wait": int(min(_LONG_POLL, left))}
            patience = self._timeout + query["wait"]
            job = self._job("GET", f"/v1/jobs/{job_id}", params=query, timeout=patience)
            if left < 1 and not job.ended:
                time.sleep(min(left, 0.1))
        return self._ended(job)

    def events(
        self, job_id: str, *, after: str = "", timeout: float | None = None
    ) -> Iterator[Event]:
        """The events of a job as they come, until its end.

        A stream that breaks is taken up again after the last event seen. ``after`` is the id of
        an event to resume from; ``timeout`` is in seconds. Raises ``WaitTimeout``.
        """
        deadline = None if timeout is None else time.monotonic() + timeout
        failures = 0
        while True:
            seen = after
            try:
                for event in self._stream(job_id, after, _left(deadline, job_id)):
                    yield event
                    after = event.id or after
                    if event.terminal:
                        return
                    _left(deadline, job_id)
                error: Exception = BadReply("The service keeps ending the stream of events.")
            except (ConnectionFailed, BadReply) as broken:
                error = broken
            _left(deadline, job_id)
            failures = 0 if after != seen else failures + 1
            if failures > self._transport.retries.tries:
                raise error
            time.sleep(self._transport.retries.pause(failures, BadReply("")))

    def cancel(self, job_id: str, *, now: bool = False) -> Job:
        """Cancel a job; it keeps its best iterate. ``now`` kills it without asking first."""
        body = {"mode": "now"} if now else {}
        return self._job("POST", f"/v1/jobs/{job_id}/cancel", json=body)

    def delete(self, job_id: str) -> None:
        """Forget an ended job with its result; a live one is cancelled instead."""
        try:
            self._transport.request("DELETE", f"/v1/jobs/{job_id}")
        except UnknownJob:  # a first try may have deleted it and lost the answer
            return

    def result(self, job_id: str) -> Result:
        """The result of a job that has ended, also of a cancelled one that got so far."""
        return read_result(self._transport.json("GET", f"/v1/jobs/{job_id}/result"))

    def trajectory(
        self,
        job_id: str,
        *,
        samples: int | None = None,
        dt: float | None = None,
        fields: list[str] | None = None,
    ) -> dict[str, Floats]:
        """The result's curves at times of your choice, sampled by the service.

        Arrays are named ``phase/time`` and ``phase/group/name``.

        Parameters
        ----------
        samples : int, optional
            How many times per phase.
        dt : float, optional
            Seconds from time to time, instead of ``samples``.
        fields : list of str, optional
            Names or groups; all unless given.
        """
        asked = {"samples": samples, "dt": dt, "fields": ",".join(fields) if fields else None}
        query = {name: value for name, value in asked.items() if value is not None}
        headers = {"Accept": "application/x-npz"}
        path = f"/v1/jobs/{job_id}/trajectory"
        response = self._transport.request("GET", path, params=query, headers=headers)
        try:
            with np.load(io.BytesIO(response.content), allow_pickle=False) as arrays:
                return {name: arrays[name] for name in arrays.files}
        except (ValueError, OSError, EOFError) as error:
            raise BadReply("The service sent a trajectory that cannot be read.") from error

    def report(self, job_id: str) -> str:
        """The report of a job: one self-contained HTML page."""
        return self._transport.request("GET", f"/v1/jobs/{job_id}/report.html").text

    def examples(self) -> list[dict[str, Any]]:
        """The gallery: name and description of each example."""
        listing = self._transport.json("GET", "/v1/examples")
        found: list[dict[str, Any]] = listing["examples"] if isinstance(listing, dict) else listing
        return found

    def example(self, name: str) -> dict[str, Any]:
        """One problem of the gallery."""
        problem: dict[str, Any] = self._transport.json("GET", f"/v1/examples/{name}")
        return problem

    def ready(self) -> dict[str, Any]:
        """Whether the service can take work: its queue and workers. Raises ``TryLater``."""
        state: dict[str, Any] = self._transport.json("GET", "/readyz")
        return state

    def _job(self, method: str, path: str, **options: Any) -> Job:
        return Job.read(self._transport.json(method, path, **options))

    def _stream(self, job_id: str, after: str, left: float) -> Iterator[Event]:
        headers = {"Accept": "text/event-stream"} | ({"Last-Event-ID": after} if after else {})
        timeout = httpx.Timeout(self._timeout, read=min(_SILENCE, left))
        path = f"/v1/jobs/{job_id}/events"
        with self._transport.stream(path, headers=headers, timeout=timeout) as lines:
            yield from parse(lines)

    def _ended(self, job: Job) -> Result:
        if job.error is None:
            return self.result(job.id)
        raise _failure(job.error)


def _failure(error: Mapping[str, Any]) -> BadProblem | JobFailed:
    if error.get("issues"):
        return BadProblem(read_issues(error["issues"]))
    return JobFailed(f"The job failed ({error['type']}): {error['message']}", error.get("hint", ""))


def _left(deadline: float | None, job_id: str) -> float:
    left = float("inf") if deadline is None else deadline - time.monotonic()
    if left <= 0:
        raise WaitTimeout(f"The job {job_id} has not ended in time.", "It goes on: wait again.")
    return left
