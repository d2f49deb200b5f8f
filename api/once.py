"""Making something for a request exactly once, however often the request comes."""

from collections.abc import Callable
from functools import partial
from typing import TypeVar

from api.errors import KeyReused
from schemas.errors import Conflict, QueueFull, RateLimited, UnknownJob, UnknownSweep
from store.ports import KEY_REUSED, Store

R = TypeVar("R")
Made = Callable[[str], None]


def once(
    store: Store,
    key: tuple[str, str | None],
    fingerprint: str,
    make: Callable[[Made], R],
    find: Callable[[str], R],
) -> tuple[R, bool]:
    """What ``make`` makes, or ``find`` finds because the key came before (then True).

    Returns once it is on disk. ``key`` is the owner and the idempotency key, if there is one.
    ``make`` tells the id of what it made before it puts anything into the queue: should that
    fail halfway, the repeated request finds it. Raises Conflict, KeyReused, and what they raise.
    """
    owner, name = key
    if name is None:
        made, found = make(lambda _: None), False
    else:
        earlier = _begin(store, owner, name, fingerprint)
        if earlier is not None:
            made, found = _again(earlier, find), True
        else:
            made, found = _first(store, owner, name, make), False
    store.durable()  # also for what was found: the first request may have failed at just this
    return made, found


def _begin(store: Store, owner: str, name: str, fingerprint: str) -> str | None:
    try:
        return store.idempotency.begin(owner, name, fingerprint)
    except Conflict as conflict:
        if conflict.message == KEY_REUSED:
            raise KeyReused("This key came before, with another body.", conflict.hint) from None
        raise Conflict("A request with this key is still in flight.", conflict.hint) from None


def _first(store: Store, owner: str, name: str, make: Callable[[Made], R]) -> R:
    try:
        return make(partial(store.idempotency.finish, owner, name))
    except (RateLimited, QueueFull):
        store.idempotency.abandon(owner, name)
        raise


def _again(earlier: str, find: Callable[[str], R]) -> R:
    try:
        return find(earlier)
    except (UnknownJob, UnknownSweep):
        words = "What this idempotency key made was deleted."
        raise Conflict(words, "Use a new key for a new request.") from None
