"""What each tool's process does: solve at a setting, or search for the coarsest good one.

Run by ``benchmarks.peers``, in the tool's own environment:

    python -m benchmarks.peers.with_TOOL cart_pole solve RUNS FAMILY SETTING
    python -m benchmarks.peers.with_TOOL cart_pole search SECONDS [FAMILY]
"""

import json
import math
import resource
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from benchmarks.peers.problems import PROBLEMS, Problem

EQUAL = 1e-5
"""Relative error of the objective at which tools are compared."""

_BEST_OF = 3  # solves of each setting that is good enough, before families are compared


@dataclass(frozen=True)
class Solved:
    """One solve from nothing: building included in ``seconds``, not in ``nlp_seconds``.

    ``objective`` is nan where the tool reported failure, ``iterations`` None where it tells none.
    """

    objective: float
    seconds: float
    nlp_seconds: float
    iterations: int | None


@dataclass(frozen=True)
class Tool:
    """A tool: its solve at (problem, family, setting); each family's settings, coarse to fine."""

    solve: Callable[[Problem, str, int], Solved]
    families: Mapping[str, Sequence[int]]


def ladder(low: int, high: int) -> list[int]:
    """Whole numbers from ``low`` to ``high``, each about a fifth more than the one before."""
    steps = range(math.ceil(math.log(high / low) / math.log(1.2)) + 1)
    return sorted({min(high, round(low * 1.2**k)) for k in steps})


def main(tool: Tool) -> None:
    """Do what the command line says; print one line of JSON."""
    problem, action, *rest = sys.argv[1:]
    given = PROBLEMS[problem]
    if action == "search":
        chosen = [name for name in tool.families if name in rest[1:]] or list(tool.families)
        answer = _search(tool, given, float(rest[0]), chosen)
    else:
        answer = _solve(tool, given, int(rest[0]), rest[1], int(rest[2]))
    print(json.dumps(answer))


def _solve(tool: Tool, problem: Problem, runs: int, family: str, setting: int) -> dict[str, object]:
    solved = [tool.solve(problem, family, setting) for _ in range(runs)]
    best = min(solved, key=lambda s: s.seconds)
    alone = min(s.nlp_seconds for s in solved)
    error = best.objective / problem.optimum - 1
    return asdict(best) | {"nlp_seconds": alone, "error": error, "megabytes": _peak_megabytes()}


def _search(
    tool: Tool, problem: Problem, seconds: float, families: Sequence[str]
) -> dict[str, object] | None:
    """Of each family's coarsest setting that is accurate, the one solved fastest; None: none is.

    A setting counts only if the next finer one is accurate, too: else its error merely changed
    its sign there.
    """
    deadline = time.perf_counter() + seconds
    found = []
    for family in families:
        setting = _coarsest(tool, problem, family, deadline)
        if setting is not None:
            seconds = min(tool.solve(problem, family, setting).seconds for _ in range(_BEST_OF))
            found.append((seconds, family, setting))
    return {"family": min(found)[1], "setting": min(found)[2]} if found else None


def _coarsest(tool: Tool, problem: Problem, family: str, deadline: float) -> int | None:
    before = None
    for setting in tool.families[family]:
        if time.perf_counter() > deadline:
            return None
        objective = tool.solve(problem, family, setting).objective
        good = abs(objective / problem.optimum - 1) <= EQUAL
        if good and before is not None:
            return before
        before = setting if good else None
    return None


def _peak_megabytes() -> float:
    """The process's largest resident memory; where /proc tells it, without what a fork inherits."""
    status = Path("/proc/self/status")
    if status.exists():
        (line,) = [row for row in status.read_text().splitlines() if row.startswith("VmHWM")]
        return int(line.split()[1]) / 1024
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1024**2 if sys.platform == "darwin" else 1024)
