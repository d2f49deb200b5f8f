"""Connecting to the server: URL, patience, and foreign errors turned into ours."""

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

from redis import Redis
from redis.backoff import ExponentialWithJitterBackoff
from redis.exceptions import (
    AuthenticationError,
    ConnectionError,  # noqa: A004 - redis names it so
    OutOfMemoryError,
    ReadOnlyError,
    RedisError,
    ResponseError,
    TimeoutError,  # noqa: A004
)
from redis.retry import Retry

from schemas.errors import StoreUnavailable
from store.settings import Patience

P = ParamSpec("P")
R = TypeVar("R")


def open_client(url: str, patience: Patience) -> "Redis":
    """A client; it connects on its first command.

    ``url`` is ``redis://[user:password@]host:port/db``, ``rediss://...`` or ``unix:///socket``.
    Raises StoreUnavailable if it is none of these.
    """
    again = (ConnectionError, TimeoutError) if patience.silence else (ConnectionError,)
    pauses = ExponentialWithJitterBackoff(base=patience.first_pause, cap=patience.longest_pause)
    try:
        return Redis.from_url(
            url,
            retry=Retry(pauses, patience.tries, again),
            socket_timeout=patience.reply,
            socket_connect_timeout=min(patience.reply, 2.0),
            health_check_interval=0,
            driver_info=None,  # it would read redis-py's version from disk for each connection
        )
    except ValueError:  # its words may hold a part of the password
        raise StoreUnavailable(
            "REDIS_URL is not the URL of a queue server.",
            "Write redis://[user:password@]host:port/db, rediss://... or unix:///socket; "
            "in a password, %-encode all but letters and digits.",
        ) from None


def translated(method: Callable[P, R]) -> Callable[P, R]:
    """Let a port's method raise StoreUnavailable instead of redis-py's errors."""

    @wraps(method)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            return method(*args, **kwargs)
        except RedisError as error:
            raise unavailable(error) from error

    return wrapper


def unavailable(error: RedisError) -> Exception:
    """Our name for an error of redis-py; a wrong command is a bug of ours and stays as it is."""
    if isinstance(error, AuthenticationError):
        return StoreUnavailable(
            "The queue server refuses the password.", "Mend the password in REDIS_URL."
        )
    if isinstance(error, OutOfMemoryError):
        return StoreUnavailable(
            "The queue server is out of memory.", "Give it more, or forget some results."
        )
    if isinstance(error, ResponseError) and "MISCONF" in str(error):
        return StoreUnavailable(
            "The queue server cannot write to its disk.", "Make room on the disk that it writes to."
        )
    if isinstance(error, ResponseError) and "HELLO" in str(error):  # the first word of redis-py
        return StoreUnavailable("The queue server is too old.", "Run Redis or Valkey 6.2 or later.")
    if isinstance(error, ConnectionError | TimeoutError | ReadOnlyError):
        return StoreUnavailable(f"The queue server does not answer: {error}", "Try again later.")
    return error
