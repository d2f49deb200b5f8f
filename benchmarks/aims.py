"""The times that are promised: build and solve, without certificate, of examples by name.

Run: python -m benchmarks.aims. What is not in the gallery is told, not passed over.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import examples
from schemas.reading import read_problem
from schemas.results import Solution
from solver import solve

RUNS = 3
"""The best counts: others use the machine, too."""

_OBJECTIVES = ("torque", "torque_rate", "acceleration", "jerk", "snap")


@dataclass(frozen=True)
class Aim:
    """An example's seconds on its own first mesh; with ``stages``, of each stage."""

    example: str
    seconds: float
    stages: bool = False


AIMS = (
    Aim("cart_pole_dircol5i_snap", 1.0),
    *(Aim(f"pendulum_{name}{end}", 0.2) for end in ("", "_limited") for name in _OBJECTIVES),
    *(
        Aim(f"slip_{name}", 0.5, stages=True)
        for name in ("str", "stl_str", "sli_str", "sli_stl_str")
    ),
)


def main() -> None:
    """Print the table, and what is missing."""
    there = set(examples.names())
    print(f"\nbuild and solve without certificate, best of {RUNS}, on the example's first mesh")
    print(f"{'':32}{'seconds':>10}{'aim':>8}{'objective':>16}  status")
    for aim in AIMS:
        if aim.example in there:
            print(*_rows(aim), sep="\n")
    missing = [aim.example for aim in AIMS if aim.example not in there]
    if missing:
        print(f"NOT MEASURED, {len(missing)} of {len(AIMS)} examples are not there:")
        print(*(f"  {name}" for name in missing), sep="\n")


def _rows(aim: Aim) -> Iterator[str]:
    """One line for an example, or one for each of its stages."""
    problem = read_problem(examples.load(aim.example) | {"refinement": None})
    results = [solve(problem) for _ in range(RUNS)]
    best = min(results, key=_seconds)
    if not aim.stages:
        yield _row(aim.example, _seconds(best), aim.seconds, best.objective, best.status)
        return
    for index, stage in enumerate(best.stages):
        label = f"{aim.example}, step {index + 1}"
        seconds = min(result.stages[index].seconds for result in results)
        yield _row(label, seconds, aim.seconds, stage.objective, stage.status)
    if not best.stages:
        yield f"{aim.example:32}  MISSED: the result tells no stages"


def _seconds(result: Solution) -> float:
    return result.timing.build + result.timing.solve


def _row(label: str, seconds: float, aim: float, objective: float | None, status: str) -> str:
    value = "-" if objective is None else f"{objective:.8g}"
    said = "" if seconds <= aim else "  MISSED"
    return f"{label:32}{seconds:10.3f}{aim:8.1f}{value:>16}  {status}{said}"


if __name__ == "__main__":
    main()
