"""Job records in Redis hashes; every move is one Lua script."""

import time
import uuid
from builtins import list as list_of
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any, cast

from redis import Redis

from schemas.errors import Conflict, UnknownJob
from schemas.events import StateChanged
from schemas.jobs import TERMINAL, JobError, JobKind, JobStatus, JobTimings, Progress
from store import cursors
from store.backend import codec, keys, scripts
from store.backend.connection import translated
from store.backend.listing import entries
from store.moves import Changes, allowed, ending, is_asked, is_due
from store.ports import JobRecord, Page
from store.settings import StoreSettings

_CHUNK = 100
_LONGEST_SCAN = 20
"""Chunks that one page of a filtered listing may read; the cursor goes on from there."""


class RedisJobs:
    """Fills the port ``Jobs``."""

    def __init__(self, client: Redis, settings: StoreSettings) -> None:
        self._client = client
        self._settings = settings
        self._move = client.register_script(scripts.MOVE)
        self._update = client.register_script(scripts.UPDATE)

    @translated
    def create(self, record: JobRecord, problem: bytes) -> None:
        """Store a queued record and its problem."""
        event = StateChanged(status=record.status, terminal=False).model_dump_json()
        with self._client.pipeline() as pipe:
            pipe.hset(keys.record(record.id), mapping=cast(Any, codec.record_fields(record)))
            pipe.set(keys.problem(record.id), codec.pack(problem))
            if record.kind is not JobKind.SWEEP_CHUNK:
                pipe.zadd(keys.owner(record.owner), {record.id: record.created})
            pipe.sadd(keys.LIVE, record.id)
            pipe.xadd(keys.events(record.id), {"event": event})
            pipe.execute()

    @translated
    def get(self, job_id: str, owner: str | None = None) -> JobRecord:
        """The record; one whose result has had its time is moved to expired here."""
        stored = cast(dict[bytes, bytes], self._client.hgetall(keys.record(job_id)))
        record = codec.to_record(stored) if stored else None
        if record is None or (owner is not None and record.owner != owner):
            raise UnknownJob(f"There is no job {job_id!r}.", "List yours with GET /v1/jobs.")
        if is_due(record, self._settings.retention):
            return self._expire(record)
        return record

    @translated
    def problem(self, job_id: str) -> bytes:
        """The stored problem."""
        stored = codec.unpack(cast(bytes | None, self._client.get(keys.problem(job_id))))
        if stored is None:
            raise UnknownJob(f"There is no job {job_id!r}.")
        return stored

    @translated
    def list(
        self,
        owner: str,
        *,
        status: JobStatus | None = None,
        name: str | None = None,
        kind: JobKind | None = None,
        cursor: str | None = None,
        limit: int = 50,
    ) -> Page:
        """An owner's jobs, newest first."""
        after = cursors.decode(cursor) if cursor else None
        found: list_of[JobRecord] = []
        for _ in range(_LONGEST_SCAN):
            chunk = self._chunk(owner, after)
            for created, job_id, record in chunk:
                after = (created, job_id)
                if record and is_asked(record, status, name, kind):
                    found.append(record)
                if len(found) == limit:
                    return Page(found, cursors.encode(*after))
            if len(chunk) < _CHUNK:
                return Page(found, None)
        return Page(found, cursors.encode(*after) if after else None)

    def _chunk(
        self, owner: str, after: tuple[float, str] | None
    ) -> list_of[tuple[float, str, JobRecord | None]]:
        """The next entries of the owner's index; those of forgotten records are swept out."""
        index = keys.owner(owner)
        found = entries(self._client, index, after, _CHUNK)
        records = self._records([job_id for _, job_id in found])
        chunk = [
            (created, job_id, record)
            for (created, job_id), record in zip(found, records, strict=True)
        ]
        forgotten = [job_id for _, job_id, record in chunk if not record]
        if forgotten:
            self._client.zrem(index, *forgotten)
        return chunk

    @translated
    def many(self, job_ids: Sequence[str]) -> list_of[JobRecord | None]:
        """The records of several jobs at once."""
        return self._records([*job_ids])

    def _records(self, ids: list_of[str]) -> list_of[JobRecord | None]:
        with self._client.pipeline(transaction=False) as pipe:
            for job_id in ids:
                pipe.hgetall(keys.record(job_id))
            records = [codec.to_record(stored) if stored else None for stored in pipe.execute()]
        retention = self._settings.retention
        return [
            self._expire(record) if record and is_due(record, retention) else record
            for record in records
        ]

    @translated
    def live(self) -> list_of[JobRecord]:
        """All jobs that have not ended."""
        ids = [member.decode() for member in cast(set[bytes], self._client.smembers(keys.LIVE))]
        return [record for record in self._records(ids) if record]

    @translated
    def claim(self, job_id: str, worker: str) -> JobRecord | None:
        """Queued -> running with a new token."""
        return self._try(
            job_id,
            JobStatus.RUNNING,
            frozenset({JobStatus.QUEUED}),
            changes=Changes(token=uuid.uuid4().hex, worker=worker, started=time.time()),
            counter="attempts",
        )

    @translated
    def move(
        self,
        job_id: str,
        to: JobStatus,
        *,
        expect: frozenset[JobStatus],
        token: str | None = None,
        solution_status: str | None = None,
        message: str = "",
        error: JobError | None = None,
        timings: JobTimings | None = None,
        killed: bool = False,
    ) -> JobRecord | None:
        """Move by compare-and-set."""
        changes = Changes(
            finished=ending(to),
            token="" if to is JobStatus.QUEUED else None,
            solution_status=solution_status,
            message=message,
            error=error,
            timings=timings,
        )
        counter = "kills" if killed else ""
        return self._try(job_id, to, expect, token=token, changes=changes, counter=counter)

    def _try(
        self,
        job_id: str,
        to: JobStatus,
        expect: frozenset[JobStatus],
        *,
        token: str | None = None,
        changes: Changes,
        counter: str = "",
    ) -> JobRecord | None:
        settings, sources = self._settings, allowed(to, expect)
        pairs = codec.to_fields(**{name: getattr(changes, name) for name in asdict(changes)})
        moved = self._move(
            keys=[*keys.of_job(job_id), keys.LIVE],
            args=[
                job_id,
                to,
                f",{','.join(sorted(sources))},",
                token or "",
                (token or "") if changes.token is None else changes.token,
                int(to in TERMINAL),
                changes.message or "",
                counter,
                int(settings.retention),
                int(settings.memory),
                settings.events_limit,
                keys.CHANGED,
                *(text for pair in pairs.items() for text in pair),
            ],
        )
        return self.get(job_id) if moved else None

    def _expire(self, record: JobRecord) -> JobRecord:
        message = record.message
        expired = self.move(
            record.id, JobStatus.EXPIRED, expect=frozenset({record.status}), message=message
        )
        return expired or record

    @translated
    def update(self, job_id: str, token: str, progress: Progress, timings: JobTimings) -> bool:
        """Progress of the live attempt."""
        pairs = codec.to_fields(progress=progress, timings=timings)
        texts = [text for pair in pairs.items() for text in pair]
        return bool(self._update(keys=[keys.record(job_id)], args=[token, *texts]))

    @translated
    def delete(self, job_id: str, owner: str) -> None:
        """Forget an ended job."""
        record = self.get(job_id, owner)
        if record.status not in TERMINAL:
            raise Conflict(f"The job is {record.status}.", "Cancel it first.")
        with self._client.pipeline() as pipe:
            pipe.delete(*keys.of_job(job_id))
            pipe.zrem(keys.owner(owner), job_id)
            pipe.execute()
