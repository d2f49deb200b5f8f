"""Idempotency keys: one small JSON document each."""

import json
from typing import cast

from redis import Redis

from schemas.errors import Conflict
from store.backend import keys
from store.backend.connection import translated
from store.ports import KEY_IN_FLIGHT, KEY_REUSED

KEPT = 86_400
IN_FLIGHT = 60
"""Seconds after which a key is free again if its request died without a word."""


class RedisIdempotency:
    """Fills the port ``Idempotency``."""

    def __init__(self, client: Redis) -> None:
        self._client = client

    @translated
    def begin(self, owner: str, key: str, fingerprint: str) -> str | None:
        """Reserve a key."""
        name = keys.idempotency(owner, key)
        fresh = json.dumps({"fingerprint": fingerprint, "job": ""})
        if self._client.set(name, fresh, nx=True, ex=IN_FLIGHT):
            return None
        stored = cast(bytes | None, self._client.get(name))
        if stored is None:  # it expired between the two commands
            return self.begin(owner, key, fingerprint)
        earlier = json.loads(stored)
        if earlier["fingerprint"] != fingerprint:
            raise Conflict(KEY_REUSED, "Use a new key for a new request.")
        if not earlier["job"]:
            raise Conflict(KEY_IN_FLIGHT, "Wait for the answer to the first request.")
        return str(earlier["job"])

    @translated
    def finish(self, owner: str, key: str, job_id: str) -> None:
        """The key has made this job."""
        name = keys.idempotency(owner, key)
        stored = cast(bytes | None, self._client.get(name))
        entry = json.loads(stored) if stored else {"fingerprint": ""}
        self._client.set(name, json.dumps({**entry, "job": job_id}), ex=KEPT)

    @translated
    def abandon(self, owner: str, key: str) -> None:
        """The key is free again."""
        self._client.delete(keys.idempotency(owner, key))
