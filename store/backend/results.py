"""Results and reports, compressed, each in a key of its own."""

from typing import cast

from redis import Redis

from store.backend import codec, keys, scripts
from store.backend.connection import translated


class RedisResults:
    """Fills the port ``Results``. The move that ends the job sets the time a result is kept."""

    def __init__(self, client: Redis) -> None:
        self._client = client
        self._put = client.register_script(scripts.PUT)
        self._put_report = client.register_script(scripts.PUT_REPORT)

    @translated
    def put(self, job_id: str, token: str, result: bytes) -> bool:
        """Store for the live attempt."""
        names = [keys.record(job_id), keys.result(job_id)]
        return bool(self._put(keys=names, args=[token, codec.pack(result)]))

    @translated
    def put_report(self, job_id: str, token: str, report: bytes) -> bool:
        """Store beside the result."""
        names = [keys.record(job_id), keys.result(job_id), keys.report(job_id)]
        return bool(self._put_report(keys=names, args=[token, codec.pack(report)]))

    @translated
    def get(self, job_id: str) -> bytes | None:
        """The result's JSON, or None."""
        return codec.unpack(cast(bytes | None, self._client.get(keys.result(job_id))))

    @translated
    def report(self, job_id: str) -> bytes | None:
        """The report's HTML, or None."""
        return codec.unpack(cast(bytes | None, self._client.get(keys.report(job_id))))
