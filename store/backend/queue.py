"""The queue: RQ, carrying ids as JSON, and what the living workers tell of themselves."""

import json
from typing import Any, cast

from redis import Redis
from rq import Queue
from rq.command import send_stop_job_command
from rq.exceptions import InvalidJobOperation, NoSuchJobError
from rq.job import Job
from rq.serializers import JSONSerializer

from schemas.errors import QueueFull
from store.backend import keys
from store.backend.connection import translated
from store.settings import StoreSettings

NAME = "footfall"
"""One queue: a worker on two could lose a job for ever."""

TASK = "worker.run.perform"
"""What RQ calls with the id, by name, since the store knows no worker."""

_KEPT = 3600
"""Seconds for which RQ remembers an ended job. Ours is the record that counts."""


def open_queue(client: Redis) -> Queue:
    """RQ's queue; never pickle, which would run the code of whoever can write to the server."""
    return Queue(NAME, connection=client, serializer=JSONSerializer)


class RedisQueue:
    """Fills the port ``Queue``."""

    def __init__(self, client: Redis, settings: StoreSettings) -> None:
        self._client = client
        self._settings = settings
        self._queue = open_queue(client)

    @translated
    def enqueue(self, job_id: str) -> None:
        """Queue an id."""
        limit = self._settings.queue_limit
        if self.length() >= limit:
            raise QueueFull(f"{limit} jobs are waiting, as many as may.", "Try again later.")
        self._push(job_id, at_front=False)

    @translated
    def requeue(self, job_id: str) -> None:
        """Queue an id whose attempt was lost, as the next one."""
        self._push(job_id, at_front=True)

    def _push(self, job_id: str, *, at_front: bool) -> None:
        seconds = self._client.hget(keys.record(job_id), "seconds")
        budget = float(cast(bytes, seconds or b"0"))
        self._client.lrem(self._queue.intermediate_queue_key, 0, job_id)
        # RQ's own memory of an earlier attempt must not expire under the new one.
        self._client.delete(Job.key_for(job_id))
        self._queue.enqueue_call(
            TASK,
            args=(job_id,),
            job_id=job_id,
            description=f"job {job_id}",
            timeout=int(budget + self._settings.outer_net) + 1,
            result_ttl=_KEPT,
            failure_ttl=_KEPT,
            at_front=at_front,
        )

    @translated
    def waiting(self) -> list[str]:
        """The ids in the queue."""
        return [entry.decode() for entry in cast(Any, self._client.lrange(self._queue.key, 0, -1))]

    @translated
    def position(self, job_id: str) -> int | None:
        """0 is next."""
        return cast(int | None, self._client.lpos(self._queue.key, job_id))

    @translated
    def remove(self, job_id: str) -> None:
        """Take a waiting id out."""
        self._client.lrem(self._queue.key, 0, job_id)

    @translated
    def stop(self, job_id: str) -> None:
        """Ask the worker to kill its process; a job that no worker has is left alone."""
        try:
            send_stop_job_command(self._client, job_id, serializer=JSONSerializer)
        except (NoSuchJobError, InvalidJobOperation):
            return

    @translated
    def length(self) -> int:
        """How many ids wait."""
        return self._client.llen(self._queue.key)

    @translated
    def workers(self) -> list[dict[str, object]]:
        """The live workers."""
        members = cast(set[bytes], self._client.smembers(keys.WORKERS))
        names = sorted(name.decode() for name in members)
        if not names:
            return []
        found = cast(Any, self._client.mget([keys.worker(name) for name in names]))
        dead = [name for name, told in zip(names, found, strict=True) if told is None]
        if dead:
            self._client.srem(keys.WORKERS, *dead)
        return [json.loads(told) for told in found if told is not None]

    @translated
    def announce(self, worker: dict[str, object], ttl: float) -> None:
        """A worker lives."""
        name = str(worker["name"])
        with self._client.pipeline() as pipe:
            pipe.set(keys.worker(name), json.dumps(worker), px=int(ttl * 1000))
            pipe.sadd(keys.WORKERS, name)
            pipe.execute()

    @translated
    def retire(self, worker: str) -> None:
        """A worker has ended."""
        with self._client.pipeline() as pipe:
            pipe.delete(keys.worker(worker))
            pipe.srem(keys.WORKERS, worker)
            pipe.execute()
