"""A whole service on this machine: queue server, api and workers, started and stopped together.

Each part is a process of its own. The queue server is the embedded one unless a URL is given.
All of them end with this process, also when it is killed.
"""

import ctypes
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Self

import httpx

from footfall import local
from footfall.errors import ServeFailed

_READY_SECONDS = 30.0
_STOP_SECONDS = 4.0
_BRIEF = 5.0  # seconds; a worker that ends sooner, again and again, will not do better
_MOST_BRIEF_LIVES = 3
_PR_SET_PDEATHSIG = 1


@dataclass(frozen=True, slots=True)
class ServeSettings:
    """Where to serve, with how many workers, and where the data live. Port 0: any free one."""

    host: str = "127.0.0.1"
    port: int = 8000
    workers: int = 1
    folder: Path = Path(".footfall")
    redis_url: str = ""


@dataclass
class _Part:
    """One child process, its command, its log, and when it was started."""

    name: str
    command: list[str]
    log: Path
    process: subprocess.Popen[bytes]
    started: float
    brief_lives: int = 0


@dataclass
class Service:
    """A service over ``settings``; a context manager that has started when it is entered."""

    settings: ServeSettings
    say: Callable[[str], object] = lambda _: None
    url: str = ""
    _environment: dict[str, str] = field(default_factory=dict)
    _parts: list[_Part] = field(default_factory=list)
    _stack: ExitStack = field(default_factory=ExitStack)

    def __enter__(self) -> Self:
        try:
            self._start()
        except BaseException:
            self.stop()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def stop(self) -> None:
        """Stop the parts in order; the queue server last. Accepted jobs stay on disk."""
        for part in reversed(self._parts):
            part.process.terminate()
        end = time.monotonic() + _STOP_SECONDS
        for part in reversed(self._parts):
            try:
                part.process.wait(max(0.1, end - time.monotonic()))
            except subprocess.TimeoutExpired:  # a long solve; its job is taken up next time
                part.process.kill()
                part.process.wait()
        self._parts.clear()
        self._stack.close()

    def watch(self) -> None:
        """Look after the parts: a dead worker is started again. Raises ``ServeFailed``."""
        for part in self._parts:
            code = part.process.poll()
            if code is None:
                continue
            if part.name == "api":
                raise ServeFailed(f"The api ended with {code}: {_last_words(part.log)}")
            self._revive(part, code)

    def _start(self) -> None:
        local.check_server_packages()
        port = _free_port(self.settings.host, self.settings.port)
        self.settings.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        self.url = f"http://{_reachable(self.settings.host)}:{port}"
        self._environment = os.environ | {
            "REDIS_URL": self.settings.redis_url or self._queue(),
            "FOOTFALL_HOST": self.settings.host,
            "FOOTFALL_PORT": str(port),
        }
        self._spawn("api", "api")
        for number in range(1, self.settings.workers + 1):
            self._spawn(f"worker-{number}", "worker")
        self._wait_until_ready()

    def _queue(self) -> str:
        with local.starting():
            server = self._stack.enter_context(local.queue_server(self.settings.folder))
        return str(server.url)

    def _spawn(self, name: str, module: str) -> None:
        command = [sys.executable, "-P", "-m", module]
        log = self.settings.folder / f"{name}.log"
        process = _launch(command, log, self._environment)
        self._parts.append(_Part(name, command, log, process, time.monotonic()))

    def _revive(self, part: _Part, code: int) -> None:
        brief = time.monotonic() - part.started < _BRIEF
        part.brief_lives = part.brief_lives + 1 if brief else 0
        if part.brief_lives >= _MOST_BRIEF_LIVES:
            raise ServeFailed(f"{part.name} keeps ending with {code}: {_last_words(part.log)}")
        self.say(f"{part.name} ended with {code} and is started again")
        part.process = _launch(part.command, part.log, self._environment)
        part.started = time.monotonic()

    def _wait_until_ready(self) -> None:
        path = "/readyz" if self.settings.workers else "/livez"
        end = time.monotonic() + _READY_SECONDS
        with httpx.Client(base_url=self.url, timeout=2.0, trust_env=False) as client:
            while time.monotonic() < end:
                self.watch()
                try:
                    if client.get(path).is_success:
                        return
                except httpx.TransportError:
                    pass  # it does not listen yet
                time.sleep(0.05)
        raise ServeFailed(
            f"The service was not ready within {_READY_SECONDS:g} s.",
            f"Its logs are in {self.settings.folder}.",
        )


def _launch(command: list[str], log: Path, environment: dict[str, str]) -> subprocess.Popen[bytes]:
    with log.open("ab") as out:
        return subprocess.Popen(  # noqa: S603 - our own interpreter and modules
            command,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=out,
            stderr=out,
            process_group=0,  # Ctrl-C is for us; we then stop the parts in order
            preexec_fn=_dying_with_parent(),  # noqa: PLW1509 - one system call, made ready before
        )


def _dying_with_parent() -> Callable[[], None] | None:
    """To run between fork and exec: let the kernel end the child with its parent (Linux)."""
    if sys.platform != "linux":
        return None
    prctl = ctypes.CDLL(None).prctl

    def ask() -> None:
        prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)

    return ask


def _reachable(host: str) -> str:
    """The host as it stands in a URL; this machine where all addresses are listened on."""
    bracketed = f"[{host}]" if ":" in host else host
    return {"0.0.0.0": "127.0.0.1", "[::]": "[::1]"}.get(bracketed, bracketed)  # noqa: S104


def _free_port(host: str, port: int) -> int:
    """The port, if it can be listened on; a free one for 0. Raises ``ServeFailed``."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        with socket.socket(family) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind((host, port))
            return int(probe.getsockname()[1])
    except OSError as error:
        hint = "Another service may run there; choose another port with --port, or stop it."
        raise ServeFailed(f"Cannot listen on {host}:{port}: {error.strerror}.", hint) from error


def _last_words(log: Path) -> str:
    lines: list[str] = []
    if log.exists():
        lines = _tail(log.open("rb")).strip().splitlines()
    return f"{lines[-1]} (all of it in {log})" if lines else f"see {log}"


def _tail(file: IO[bytes]) -> str:
    with file:
        file.seek(0, os.SEEK_END)
        file.seek(max(0, file.tell() - 4000))
        return file.read().decode(errors="replace")
