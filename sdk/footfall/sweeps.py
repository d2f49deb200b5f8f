"""Sweeps: one problem at many places, solved by a service."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any

from footfall.documents import Problem, read_problem
from footfall.errors import BadReply, UnknownSweep, WaitTimeout
from footfall.result import Result
from footfall.transport import Transport, encoded

_ENDED = frozenset({"succeeded", "failed", "cancelled"})
_EVERY = 0.5  # seconds between two looks


@dataclass(frozen=True, slots=True)
class Sweep:
    """A sweep as the service last told. ``document`` is its whole JSON.

    Each of ``points`` has its ``values`` by JSON pointer, ``status``, ``objective``,
    ``solution_status`` and ``verdict``. ``minima``: the distinct ones that several guesses found.
    """

    id: str
    name: str
    kind: str
    status: str
    total: int
    counts: dict[str, int]
    points: list[dict[str, Any]] = field(default_factory=list, repr=False)
    minima: list[dict[str, Any]] | None = None
    document: dict[str, Any] = field(default_factory=dict, repr=False)

    @property
    def ended(self) -> bool:
        """Whether no point will change any more."""
        return self.status in _ENDED

    @property
    def converged(self) -> bool:
        """Whether every point has converged."""
        return all(point["solution_status"] == "converged" for point in self.points)

    @property
    def done(self) -> int:
        """How many points have ended."""
        return self.total - self.counts["queued"] - self.counts["running"]

    @classmethod
    def read(cls, document: dict[str, Any]) -> "Sweep":
        """A sweep out of its JSON."""
        names = {item.name for item in fields(cls)} - {"document"}
        try:
            return cls(**{n: document[n] for n in names if n in document}, document=document)
        except TypeError as error:
            raise BadReply("The service answered with something that is no sweep.") from error


class SweepCalls:
    """What a client can do with sweeps."""

    _transport: Transport

    def sweep(
        self,
        problem: Problem,
        *,
        grid: Mapping[str, Sequence[Any]] | None = None,
        points: Sequence[Mapping[str, Any]] | None = None,
        multistart: int | None = None,
        idempotency_key: str | None = None,
        **options: Any,
    ) -> Sweep:
        """Queue a problem at many places: over a grid, a list of points, or several guesses.

        Parameters
        ----------
        problem : dict, str or Path
            The problem, or the path of a JSON file that holds it.
        grid : dict
            JSON pointers into the problem, each with a list of values; all combinations are
            solved, the last pointer varies fastest.
        points : list of dict
            Or each point by itself: JSON pointers with one value each.
        multistart : int
            Or so many guesses: the problem's own, then random ones.
        options
            ``name``, ``chunk`` (points that one job solves in a row) and ``warm`` (each from the
            solution of the one before it).

        Raises
        ------
        BadProblem
            With every issue of any point; nothing is queued then.
        """
        asked = {"grid": grid, "points": points, "multistart": multistart, **options}
        request = {name: value for name, value in asked.items() if value is not None}
        body = encoded({"problem": read_problem(problem), **request})
        return Sweep.read(self._transport.post_once("/v1/sweeps", body, idempotency_key))

    def sweep_state(self, sweep_id: str, *, fields: Sequence[str] | None = None) -> Sweep:
        """How a sweep is doing; of its points all, or only some ``fields`` (none: no points)."""
        query = {} if fields is None else {"fields": ",".join(fields)}
        return Sweep.read(self._transport.json("GET", f"/v1/sweeps/{sweep_id}", params=query))

    def sweeps(self) -> Iterator[Sweep]:
        """Your sweeps, newest first, without their points, page by page as you go on."""
        query: dict[str, str] = {}
        while True:
            page = self._transport.json("GET", "/v1/sweeps", params=query)
            yield from map(Sweep.read, page["sweeps"])
            if not page.get("next"):
                return
            query["cursor"] = page["next"]

    def wait_sweep(
        self,
        sweep_id: str,
        *,
        timeout: float | None = None,
        on_change: Callable[[Sweep], object] | None = None,
    ) -> Sweep:
        """The sweep with all of its points once it has ended.

        ``on_change`` is called, without points, when the counts have changed. Raises
        ``WaitTimeout`` after ``timeout`` seconds; the sweep goes on.
        """
        deadline = None if timeout is None else time.monotonic() + timeout
        counts: dict[str, int] = {}
        while True:
            state = self.sweep_state(sweep_id, fields=())
            if state.counts != counts and on_change is not None:
                on_change(state)
            counts = state.counts
            if state.ended:
                return self.sweep_state(sweep_id)
            if deadline is not None and time.monotonic() >= deadline:
                words = f"The sweep {sweep_id} has not ended in time."
                raise WaitTimeout(words, "It goes on: wait again.")
            time.sleep(_EVERY)

    def point(self, sweep_id: str, index: int) -> Result:
        """The result of one point of a sweep."""
        path = f"/v1/sweeps/{sweep_id}/points/{index}/result"
        return Result(self._transport.json("GET", path))

    def cancel_sweep(self, sweep_id: str, *, now: bool = False) -> Sweep:
        """Cancel what has not ended; points that have ended stay."""
        body = {"mode": "now"} if now else {}
        path = f"/v1/sweeps/{sweep_id}/cancel"
        return Sweep.read(self._transport.json("POST", path, json=body))

    def delete_sweep(self, sweep_id: str) -> None:
        """Forget an ended sweep with its results; a live one is cancelled instead."""
        try:
            self._transport.request("DELETE", f"/v1/sweeps/{sweep_id}")
        except UnknownSweep:  # a first try may have deleted it and lost the answer
            return
