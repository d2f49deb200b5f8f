"""Ctrl-C: the first asks, the second ends at once."""

import signal
import sys
from types import FrameType
from typing import Any, Self


class Interrupt:
    """While this is entered, the first SIGINT or SIGTERM only sets ``asked``."""

    def __init__(self, words: str = "stopping; once more ends at once") -> None:
        self._words = words
        self._asked = False
        self._before: dict[signal.Signals, Any] = {}

    def asked(self) -> bool:
        """Whether the user has asked to stop."""
        return self._asked

    def __enter__(self) -> Self:
        for kind in (signal.SIGINT, signal.SIGTERM):
            self._before[kind] = signal.signal(kind, self._heard)
        return self

    def __exit__(self, *_: object) -> None:
        for kind, handler in self._before.items():
            signal.signal(kind, handler)

    def _heard(self, _: int, __: FrameType | None) -> None:
        if self._asked:
            raise KeyboardInterrupt
        self._asked = True
        print(self._words, file=sys.stderr)
