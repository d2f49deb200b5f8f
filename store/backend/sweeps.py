"""Sweeps in Redis: a hash for the record, one for the points, a key for each result."""

import time
from builtins import list as list_of
from typing import Any, cast

from redis import Redis

from schemas.errors import UnknownSweep
from schemas.sweeps import PointOutcome
from store import cursors
from store.backend import codec, keys, scripts
from store.backend.connection import translated
from store.backend.listing import entries
from store.moves import point_event
from store.ports import JobRecord, Points, SweepRecord, SweepRecords
from store.settings import StoreSettings


class RedisSweeps:
    """Fills the port ``Sweeps``. Keys live for the store's memory after the last point ended."""

    def __init__(self, client: Redis, settings: StoreSettings) -> None:
        self._client = client
        self._settings = settings
        self._begin = client.register_script(scripts.BEGIN_POINT)
        self._end = client.register_script(scripts.END_POINT)

    @translated
    def create(self, record: SweepRecord, plan: bytes) -> None:
        """Store a sweep and its plan."""
        memory = int(self._settings.memory)
        with self._client.pipeline() as pipe:
            pipe.hset(keys.sweep(record.id), mapping=cast(Any, codec.sweep_fields(record)))
            pipe.expire(keys.sweep(record.id), memory)
            pipe.set(keys.sweep_plan(record.id), codec.pack(plan), ex=memory)
            pipe.zadd(keys.sweeps_of(record.owner), {record.id: record.created})
            pipe.execute()

    @translated
    def get(self, sweep_id: str, owner: str | None = None) -> SweepRecord:
        """The record."""
        stored = cast(dict[bytes, bytes], self._client.hgetall(keys.sweep(sweep_id)))
        record = codec.to_sweep(stored) if b"id" in stored else None
        if record is None or (owner is not None and record.owner != owner):
            raise UnknownSweep(f"There is no sweep {sweep_id!r}.", "List yours: GET /v1/sweeps.")
        return record

    @translated
    def plan(self, sweep_id: str) -> bytes:
        """The stored plan."""
        stored = codec.unpack(cast(bytes | None, self._client.get(keys.sweep_plan(sweep_id))))
        if stored is None:
            raise UnknownSweep(f"There is no sweep {sweep_id!r}.")
        return stored

    @translated
    def list(self, owner: str, *, cursor: str | None = None, limit: int = 20) -> SweepRecords:
        """An owner's sweeps, newest first."""
        after = cursors.decode(cursor) if cursor else None
        index = keys.sweeps_of(owner)
        found = entries(self._client, index, after, limit + 1)
        with self._client.pipeline(transaction=False) as pipe:
            for _, sweep_id in found[:limit]:
                pipe.hgetall(keys.sweep(sweep_id))
            stored = pipe.execute()
        shown = [*zip(found, stored, strict=False)]
        forgotten = [sweep_id for (_, sweep_id), one in shown if b"id" not in one]
        if forgotten:
            self._client.zrem(index, *forgotten)
        records: list_of[SweepRecord] = [codec.to_sweep(one) for one in stored if b"id" in one]
        more = cursors.encode(*found[limit - 1]) if len(found) > limit else None
        return SweepRecords(records, more)

    @translated
    def points(self, sweep_id: str) -> Points:
        """What is known of the points."""
        with self._client.pipeline() as pipe:
            pipe.hgetall(keys.sweep_ended(sweep_id))
            pipe.hgetall(keys.sweep_begun(sweep_id))
            ended, begun = pipe.execute()
        read = PointOutcome.model_validate_json
        return Points(
            {int(index): read(outcome) for index, outcome in ended.items()},
            {int(index): int(times) for index, times in begun.items()},
        )

    @translated
    def result(self, sweep_id: str, index: int) -> bytes | None:
        """The JSON of a point's result."""
        stored = self._client.get(keys.sweep_result(sweep_id, index))
        return codec.unpack(cast(bytes | None, stored))

    @translated
    def begin(self, sweep_id: str, index: int, job: JobRecord) -> int:
        """Note that the live attempt begins a point."""
        names = [keys.record(job.id), keys.sweep_begun(sweep_id), keys.sweep(sweep_id)]
        return int(self._begin(keys=names, args=[job.token, index]))

    @translated
    def end(
        self, sweep_id: str, index: int, job: JobRecord, outcome: PointOutcome, result: bytes | None
    ) -> bool:
        """Store how a point ended."""
        settings = self._settings
        ended = self._end(
            keys=[
                keys.record(job.id),
                keys.events(job.id),
                keys.sweep_result(sweep_id, index),
                keys.sweep_ended(sweep_id),
                keys.sweep_begun(sweep_id),
                keys.sweep(sweep_id),
                keys.sweep_plan(sweep_id),
            ],
            args=[
                job.id,
                job.token,
                index,
                outcome.model_dump_json(),
                b"" if result is None else codec.pack(result),
                point_event(index, outcome).model_dump_json(),
                settings.events_limit,
                keys.CHANGED,
                int(settings.retention),
                int(settings.memory),
            ],
        )
        return bool(ended)

    @translated
    def cancel(self, sweep_id: str) -> None:
        """Note that the sweep was asked to stop."""
        with self._client.pipeline() as pipe:
            pipe.hsetnx(keys.sweep(sweep_id), "cancelled", repr(time.time()))
            pipe.expire(keys.sweep(sweep_id), int(self._settings.memory))
            pipe.execute()

    @translated
    def delete(self, sweep_id: str, owner: str) -> None:
        """Forget a sweep and its points."""
        record = self.get(sweep_id, owner)
        results = [keys.sweep_result(sweep_id, index) for index in range(record.total)]
        with self._client.pipeline() as pipe:
            pipe.delete(*keys.of_sweep(sweep_id), *results)
            pipe.zrem(keys.sweeps_of(owner), sweep_id)
            pipe.execute()
