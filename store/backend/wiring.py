"""The one place that puts a store together."""

from redis import Redis

from store.backend.connection import open_client
from store.backend.events import RedisEvents
from store.backend.idempotency import RedisIdempotency
from store.backend.jobs import RedisJobs
from store.backend.queue import RedisQueue
from store.backend.results import RedisResults
from store.backend.server import Server
from store.backend.sweeps import RedisSweeps
from store.ports import Store
from store.settings import SHORT, Patience, StoreSettings


def connect(
    url: str, *, patience: Patience = SHORT, settings: StoreSettings | None = None
) -> Store:
    """The store of a server; it connects on first use.

    Parameters
    ----------
    url
        ``redis://[user:password@]host:port/db``, ``rediss://...`` or ``unix:///path/of/socket``.
    patience
        How long to wait for a server that is away.
    settings
        Limits and times; the defaults if None.
    """
    return assemble(open_client(url, patience), settings or StoreSettings())


def assemble(client: Redis, settings: StoreSettings) -> Store:
    """The store over a client."""
    server, events = Server(client), RedisEvents(client, settings)

    def close() -> None:
        events.close()  # first, since it still reads from a connection
        client.close()

    return Store(
        jobs=RedisJobs(client, settings),
        sweeps=RedisSweeps(client, settings),
        results=RedisResults(client),
        events=events,
        queue=RedisQueue(client, settings),
        idempotency=RedisIdempotency(client),
        durable=server.durable,
        ping=server.ping,
        uptime=server.uptime,
        close=close,
    )
