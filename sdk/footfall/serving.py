"""A whole service on this machine: queue server, api and workers, started and stopped together.

Each part is a process of its own, and is started again if it is killed. The queue server is the
embedded one unless a URL is given. All of them end with this process, also when it is killed.
"""

import os
import socket
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self

import httpx

from footfall import local
from footfall.errors import ServeFailed
from footfall.parts import Lives, Part

_READY_SECONDS = 30.0
_END_SECONDS = 3.0
"""For running jobs to end; what still runs then is handed back, for the next start."""

_HAND_BACK_SECONDS = 1.5


@dataclass(frozen=True, slots=True)
class ServeSettings:
    """Where to serve, with how many workers, and where the data live. Port 0: any free one."""

    host: str = "127.0.0.1"
    port: int = 8000
    workers: int = 1
    folder: Path = Path(".footfall")
    redis_url: str = ""


@dataclass
class Service:
    """A service over ``settings``; a context manager that has started when it is entered."""

    settings: ServeSettings
    say: Callable[[str], object] = lambda _: None
    url: str = ""
    _server: Any = None
    _server_lives: Lives = field(default_factory=Lives)
    _parts: list[Part] = field(default_factory=list)

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
        living = self._parts[::-1]
        for seconds in (_END_SECONDS, _HAND_BACK_SECONDS):
            for part in living:
                part.process.terminate()
            end = time.monotonic() + seconds
            living = [part for part in living if not part.wait(end)]
        for part in living:
            part.process.kill()
            part.process.wait()
        self._parts.clear()
        if self._server is not None:
            self._server.stop()

    def watch(self) -> None:
        """Look after the parts: what was killed is started again.

        Raises
        ------
        ServeFailed
            If the api has ended for a reason of its own, or the queue server does not start.
        """
        if self._server is not None and not self._server.running and self._server_lives.ended():
            self.say("the queue server was killed and is started again")
            self._start_server()
        for part in self._parts:
            self._look_after(part)

    def _look_after(self, part: Part) -> None:
        code = part.ended
        if code is None:
            return
        if part.name == "api" and code >= 0:
            raise ServeFailed(f"The api ended with {code}: {part.last_words()}")
        if part.lives.ended():
            self.say(f"{part.name} ended with {code} and is started again: {part.last_words()}")
            part.start_again()

    def _start(self) -> None:
        local.check_server_packages()
        port = _free_port(self.settings.host, self.settings.port)
        _make(self.settings.folder)
        self.url = f"http://{_reachable(self.settings.host)}:{port}"
        if not self.settings.redis_url:
            self._server = local.queue_server(self.settings.folder)
            self._start_server()
        environment = os.environ | {
            "REDIS_URL": self.settings.redis_url or self._server.url,
            "FOOTFALL_HOST": self.settings.host,
            "FOOTFALL_PORT": str(port),
        }
        names = [f"worker-{number}" for number in range(1, self.settings.workers + 1)]
        for name in ("api", *names):
            command = [sys.executable, "-P", "-m", name.partition("-")[0]]
            log = self.settings.folder / f"{name}.log"
            self._parts.append(Part(name, command, log, environment))
        self._wait_until_ready()

    def _start_server(self) -> None:
        with local.starting():
            self._server.start()
        self._server_lives.began()

    def _wait_until_ready(self) -> None:
        path = "/readyz" if self.settings.workers else "/livez"
        end, why = time.monotonic() + _READY_SECONDS, ""
        with httpx.Client(base_url=self.url, timeout=6.0, trust_env=False) as client:
            while time.monotonic() < end:
                self.watch()
                self._give_up_on_the_hopeless()
                try:
                    reply = client.get(path)
                except httpx.TransportError:
                    pass  # it does not listen yet
                else:
                    if reply.is_success:
                        return
                    why = f" {reply.json().get('detail', '')}"
                time.sleep(0.05)
        raise ServeFailed(
            f"The service was not ready within {_READY_SECONDS:g} s.{why}",
            f"Its logs are in {self.settings.folder}.",
        )

    def _give_up_on_the_hopeless(self) -> None:
        for part in self._parts:
            if part.lives.hopeless:
                raise ServeFailed(f"{part.name} keeps ending: {part.last_words()}")


def _make(folder: Path) -> None:
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        hint = "Choose another folder with --data-dir."
        raise ServeFailed(f"Cannot use the folder {folder}: {error.strerror}.", hint) from error


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
