"""The parts of a service on this machine: processes that are watched and started again."""

import ctypes
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO

_BRIEF = 5.0
"""Seconds; what ends sooner, again and again, will hardly do better at once."""

_MOST_BRIEF_LIVES = 3
_LONGEST_PAUSE = 10.0
_PR_SET_PDEATHSIG = 1


@dataclass
class Lives:
    """When to start something again: at once, and after a few brief lives ever more rarely."""

    started: float = field(default_factory=time.monotonic)
    brief: int = 0
    again: float | None = None

    @property
    def hopeless(self) -> bool:
        """Whether it has ended soon after each of its last starts."""
        return self.brief >= _MOST_BRIEF_LIVES

    def ended(self) -> bool:
        """It is dead; whether it is time to start it again."""
        now = time.monotonic()
        if self.again is None:
            self.brief = self.brief + 1 if now - self.started < _BRIEF else 0
            pause = 2.0 ** (self.brief - _MOST_BRIEF_LIVES) if self.hopeless else 0.0
            self.again = now + min(pause, _LONGEST_PAUSE)
        return now >= self.again

    def began(self) -> None:
        """It has been started."""
        self.started, self.again = time.monotonic(), None


class Part:
    """One child process with its command and its log. It ends with this process."""

    def __init__(
        self, name: str, command: list[str], log: Path, environment: Mapping[str, str]
    ) -> None:
        self.name = name
        self._command = command
        self._log = log
        self._environment = environment
        self.lives = Lives()
        self.process = self._launch()

    @property
    def ended(self) -> int | None:
        """The exit code, negative for a signal; None while it lives."""
        return self.process.poll()

    def start_again(self) -> None:
        """Start it again after it has ended."""
        self.process = self._launch()
        self.lives.began()

    def wait(self, until: float) -> bool:
        """Wait for its end until a time of ``time.monotonic``; whether it has ended."""
        try:
            self.process.wait(max(0.0, until - time.monotonic()))
        except subprocess.TimeoutExpired:
            return False
        return True

    def last_words(self) -> str:
        """The end of its log, for an error."""
        lines: list[str] = []
        if self._log.exists():
            lines = _tail(self._log.open("rb")).strip().splitlines()
        return f"{lines[-1]} (all of it in {self._log})" if lines else f"see {self._log}"

    def _launch(self) -> subprocess.Popen[bytes]:
        with self._log.open("ab") as out:
            return subprocess.Popen(  # noqa: S603 - our own interpreter and modules
                self._command,
                env=self._environment,
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=out,
                process_group=0,  # Ctrl-C is for us; we then stop the parts in order
                preexec_fn=_dying_with_parent(),  # noqa: PLW1509 - a system call, made ready before
            )


def _dying_with_parent() -> Callable[[], None] | None:
    """To run between fork and exec: let the kernel end the child with its parent (Linux)."""
    if sys.platform != "linux":
        return None
    prctl = ctypes.CDLL(None).prctl

    def ask() -> None:
        prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)

    return ask


def _tail(file: IO[bytes]) -> str:
    with file:
        file.seek(0, os.SEEK_END)
        file.seek(max(0, file.tell() - 4000))
        return file.read().decode(errors="replace")
