"""Running two things in turn, and printing the ratio."""

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """One comparison: median seconds of ours and of the yardstick, and the aim for the ratio."""

    what: str
    ours: float
    theirs: float
    aim: float | None = None


def timed(action: Callable[[], object]) -> float:
    """Seconds that one call takes."""
    began = time.perf_counter()
    action()
    return time.perf_counter() - began


def in_turn(runs: int, *actions: Callable[[], float]) -> list[float]:
    """The median of what each action returns, run in turn A B A B ..., the first round left out."""
    rounds = [[action() for action in actions] for _ in range(runs + 1)][1:]
    return [statistics.median(column) for column in zip(*rounds, strict=True)]


def show(title: str, rows: Sequence[Row], theirs: str = "yardstick") -> None:
    """Print the comparisons as a table, in milliseconds."""
    print(f"\n{title}")
    print(f"{'':42}{'ours ms':>10}{theirs + ' ms':>16}{'ratio':>8}  aim")
    for row in rows:
        aim = "" if row.aim is None else f"<= {row.aim:g}"
        ratio = row.ours / row.theirs
        print(f"{row.what:42}{row.ours * 1e3:10.1f}{row.theirs * 1e3:16.1f}{ratio:8.2f}  {aim}")
