"""What ``footfall doctor`` looks at: each thing, whether it works, and the mend."""

import shutil
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version

from footfall import local
from footfall.client import Client
from footfall.errors import FootfallError
from footfall.transport import Retries

_CLIENT = ("footfall", "httpx", "numpy", "rich")
_SERVER = ("footfall-server", "casadi", "scipy", "fastapi", "uvicorn", "redis", "rq")
_TINY = {
    "name": "doctor",
    "phases": [
        {
            "system": {
                "kind": "ode",
                "states": ["x", "v"],
                "controls": ["u"],
                "derivatives": {"x": "v", "v": "u"},
            },
            "time": {"final": 1},
            "initial": {"x": 0, "v": 0},
            "final": {"x": 1, "v": 0},
            "integrals": {"effort": "u^2"},
        }
    ],
    "objective": {"minimize": "effort"},
    "method": {"kind": "hermite_simpson", "segments": 4},
}
_OPTIMUM = 12.0  # u = 6 - 12 t


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing looked at. ``state``: ok, absent (not needed by all), or missing."""

    name: str
    state: str
    words: str
    mend: str = ""

    def to_dict(self) -> dict[str, str]:
        """The finding as JSON values."""
        return asdict(self)


def examine(server: str) -> list[Finding]:
    """Look at everything; nothing is changed."""
    return [
        _python(),
        *(_package(name, "missing", "pip install footfall") for name in _CLIENT),
        *(
            _package(name, "absent", "pip install 'footfall-server[api,worker]'")
            for name in _SERVER
        ),
        _attempt("engine", _solve_tiny, "pip install 'footfall-server[worker]'"),
        _attempt("queue server", _queue, "pip install 'footfall-server[embedded]'"),
        _attempt("service", lambda: _service(server), "'footfall serve' starts one."),
        _browser(),
    ]


def _python() -> Finding:
    return Finding("python", "ok", ".".join(map(str, sys.version_info[:3])))


def _package(name: str, without: str, mend: str) -> Finding:
    try:
        return Finding(name, "ok", version(name))
    except PackageNotFoundError:
        return Finding(name, without, "not installed", mend)


def _attempt(name: str, look: Callable[[], str], mend: str) -> Finding:
    try:
        return Finding(name, "ok", look())
    except FootfallError as error:
        return Finding(name, "absent", error.message, error.hint or mend)


def _solve_tiny() -> str:
    result = local.solve(_TINY)
    objective = result.objective or 0.0
    good = result.converged and abs(objective - _OPTIMUM) < 1e-6
    if not good:
        raise FootfallError(f"a tiny problem ended as {result.status} with {objective:.6g}")
    return f"solved a tiny problem in {result.document['timing']['total']:.2f} s"


def _queue() -> str:
    return local.queue_binary().name


def _service(server: str) -> str:
    with Client(server, timeout=2.0, retries=Retries(tries=0)) as client:
        state = client.ready()
    return f"{server} is ready, workers: {state.get('workers')}"


def _browser() -> Finding:
    names = ("chromium", "chromium-browser", "google-chrome")
    found = next(filter(None, map(shutil.which, names)), None)
    if found:
        return Finding("browser", "ok", found)
    mend = "Only the browser tests need it: sudo apt-get install chromium"
    return Finding("browser", "absent", "no chromium", mend)
