"""Following a job's log: the loop that both stores share."""

import re
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from schemas.events import StateChanged
from store.ports import LoggedEvent

_POLL = 2.0
"""Seconds after which a follower looks for itself, should a wake-up be lost."""

_ID = re.compile(r"[0-9]{1,19}(-[0-9]{1,19})?")


@dataclass(frozen=True, slots=True)
class Log:
    """One job's log. ``read``: what comes after an id. ``ended``: whether no more will come."""

    read: Callable[[str], list[LoggedEvent]]
    last: Callable[[], LoggedEvent | None]
    ended: Callable[[], bool]


def clean_id(after: str) -> str:
    """An event id as a client sent it; anything else means the beginning."""
    return after if _ID.fullmatch(after) else "0"


def follow(
    log: Log, changed: threading.Event, after: str, timeout: float
) -> Iterator[LoggedEvent | None]:
    """Events as they come, None on each ``timeout`` of silence, up to the terminal one."""
    silent_until = time.monotonic() + timeout
    while True:
        changed.clear()
        ended = log.ended()  # asked first: what is read next then is all there is
        for logged in log.read(after):
            after = logged.id
            yield logged
            if is_terminal(logged):
                return
            silent_until = time.monotonic() + timeout
        if ended:
            yield from _replay(log)
            return
        changed.wait(max(0.0, min(_POLL, silent_until - time.monotonic())))
        if time.monotonic() >= silent_until:
            yield None
            silent_until = time.monotonic() + timeout


def is_terminal(logged: LoggedEvent) -> bool:
    """Whether this event ends the log."""
    return isinstance(logged.event, StateChanged) and logged.event.terminal


def _replay(log: Log) -> Iterator[LoggedEvent]:
    last = log.last()
    if last is not None and is_terminal(last):
        yield last
