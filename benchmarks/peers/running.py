"""One tool on one problem: search its setting, then measure it warm and as a whole process."""

import json
import os
import resource
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.peers.installing import python_of

_ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
_PATIENCE = 90.0  # seconds for the search of one tool on one problem
_WARM, _PROCESSES = 5, 5


class Failed(Exception):
    """A tool's process ended badly; the message is the last that it said."""


@dataclass(frozen=True)
class Entrant:
    """A tool in the comparison: its module, and which of its families may run (none: all)."""

    label: str
    tool: str
    family: str = ""


@dataclass(frozen=True)
class Measured:
    """What one tool needs for the common accuracy: seconds, megabytes, relative error.

    ``processor`` is the whole process's processor time: unlike ``process``, the wall-clock time,
    it hardly grows when others use the machine.
    """

    setting: str
    error: float
    iterations: int | None
    nlp: float
    warm: float
    process: float
    processor: float
    megabytes: float


def python(entrant: Entrant) -> Path:
    """The interpreter that knows the tool. Raises ``NotInstallable``."""
    return Path(sys.executable) if entrant.tool == "footfall" else python_of(entrant.tool)


def search(entrant: Entrant, problem: str) -> tuple[str, int] | None:
    """Family and setting that the tool needs; None if none is accurate enough in time."""
    found = _ask(entrant, problem, "search", str(_PATIENCE), entrant.family)
    return (found["family"], found["setting"]) if found else None


def measure(entrant: Entrant, problem: str, family: str, setting: int) -> Measured:
    """Best of several: solves in one warm process, and processes with one solve each."""
    warm = _ask(entrant, problem, "solve", str(_WARM), family, str(setting))
    whole, processor, cold = [], [], {}
    for _ in range(_PROCESSES):
        began, used = time.perf_counter(), _processor_time()
        cold = _ask(entrant, problem, "solve", "1", family, str(setting))
        whole.append(time.perf_counter() - began)
        processor.append(_processor_time() - used)
    return Measured(
        setting=f"{family} x {setting}",
        error=warm["error"],
        iterations=warm["iterations"],
        nlp=warm["nlp_seconds"],
        warm=warm["seconds"],
        process=min(whole),
        processor=min(processor),
        megabytes=cold["megabytes"],
    )


def _processor_time() -> float:
    """Of all processes that this one started and that ended, in s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _environment() -> dict[str, str]:
    """One thread; and bytecode is kept, as that of an installed tool is.

    Else a tool that runs from its sources compiles them in every process, and the others do not.
    """
    compiled = {key: text for key, text in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    return compiled | _ONE_THREAD


def _ask(entrant: Entrant, problem: str, *arguments: str) -> Any:
    module = f"benchmarks.peers.with_{entrant.tool}"
    command: list[str | Path] = [python(entrant), "-W", "ignore", "-m", module, problem, *arguments]
    done = subprocess.run(  # noqa: S603 - our own command
        command, capture_output=True, text=True, env=_environment(), check=False
    )
    if done.returncode:
        raise Failed((done.stderr.strip().splitlines() or ["no message"])[-1])
    return json.loads(done.stdout.splitlines()[-1])
