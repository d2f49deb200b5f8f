"""What a process keeps of the functions it has built, for the next problem of the same shape.

Points of a sweep, the meshes of a refinement, several starts, stages: all of these put other
numbers into the same functions. A key says all that a function was built from; what is not asked
for any more makes room.
"""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from threading import Lock
from typing import Generic, TypeVar

Value = TypeVar("Value")

_ALL: list["Kept[object]"] = []


class Kept(Generic[Value]):
    """Values by key, the least recently used of them dropped.

    Parameters
    ----------
    room
        How much is kept altogether, in the unit of ``size``.
    size
        How large a value is, told when it is made.
    """

    def __init__(self, room: int, size: Callable[[Value], int] = lambda _: 1) -> None:
        self._room, self._size, self._used = room, size, 0
        self._values: OrderedDict[Hashable, tuple[Value, int]] = OrderedDict()
        self._lock = Lock()
        _ALL.append(self)  # type: ignore[arg-type]

    def __len__(self) -> int:
        """How many values there are."""
        return len(self._values)

    def get(self, key: Hashable, make: Callable[[], Value]) -> Value:
        """The value of the key, made where there is none."""
        with self._lock:
            if key in self._values:
                self._values.move_to_end(key)
                return self._values[key][0]
        value = make()  # not under the lock: it may take long, and ask for other values
        self._keep(key, value)
        return value

    def _keep(self, key: Hashable, value: Value) -> None:
        size = self._size(value)
        if size > self._room:
            return
        with self._lock:
            self._used += size - self._values.pop(key, (value, 0))[1]
            self._values[key] = value, size
            while self._used > self._room:
                self._used -= self._values.popitem(last=False)[1][1]

    def clear(self) -> None:
        """Drop all values."""
        with self._lock:
            self._values.clear()
            self._used = 0


def forget() -> None:
    """Drop all that this process keeps, as if it had just started."""
    for kept in _ALL:
        kept.clear()
