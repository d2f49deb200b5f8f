"""The times that are promised: build and solve, without certificate, of examples by name.

Run: python -m benchmarks.aims. What is not in the gallery is told, not passed over.
"""

import time
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass

import examples
from schemas.events import EngineEvent, StageStarted
from schemas.guesses import Guess
from schemas.problem import Problem
from schemas.reading import read_problem
from schemas.results import Solution
from schemas.stages import apply_stage
from solver import solve
from solver.campaign.stages import solution_guess

RUNS = 5
"""The best counts: others use the machine, too."""

_OBJECTIVES = ("torque", "torque_rate", "acceleration", "jerk", "snap")


@dataclass(frozen=True)
class Aim:
    """An example's seconds on its own first mesh; with ``stages``, of each stage on that."""

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
    print("processor seconds: on an idle machine, those of the clock")
    print(f"{'':32}{'seconds':>10}{'aim':>8}{'iterations':>12}{'objective':>16}  status")
    for aim in AIMS:
        if aim.example in there:
            print(*_rows(aim), sep="\n")
    missing = [aim.example for aim in AIMS if aim.example not in there]
    if missing:
        print(f"NOT MEASURED, {len(missing)} of {len(AIMS)} examples are not there:")
        print(*(f"  {name}" for name in missing), sep="\n")


class Clock:
    """Processor seconds of each stage of a solve: what others do on the machine does not count."""

    def __init__(self) -> None:
        self.spent: dict[str, float] = defaultdict(float)
        self.stage, self.since = "", time.process_time()

    def __call__(self, event: EngineEvent) -> None:
        """Take note where one stage ends and another starts."""
        if isinstance(event, StageStarted):
            now = time.process_time()
            self.spent[self.stage] += now - self.since
            self.stage, self.since = event.stage, now

    @property
    def seconds(self) -> float:
        """To build and to solve."""
        return self.spent["build"] + self.spent["solve"]


def _rows(aim: Aim) -> Iterator[str]:
    """One line for an example, or one for each of its stages, each on its first mesh."""
    problem = read_problem(examples.load(aim.example) | {"refinement": None})
    if not aim.stages:
        yield _row(aim.example, aim.seconds, *_measured(problem))
        return
    guess: Guess = problem.guess
    for index in range(len(problem.stages)):
        stage = apply_stage(problem, index).model_copy(update={"refinement": None, "guess": guess})
        seconds, result = _measured(stage)
        guess = solution_guess(result)
        yield _row(f"{aim.example}, step {index + 1}", aim.seconds, seconds, result)


def _measured(problem: Problem) -> tuple[float, Solution]:
    """The least processor seconds to build and solve, and the solution."""
    runs = []
    for _ in range(RUNS):
        clock = Clock()
        runs.append((solve(problem, on_event=clock), clock.seconds))
    return min(seconds for _, seconds in runs), runs[0][0]


def _row(label: str, aim: float, seconds: float, result: Solution) -> str:
    value = "-" if result.objective is None else f"{result.objective:.8g}"
    iterations = sum(mesh.nlp_iterations for mesh in result.mesh_refinement.iterations)
    said = "" if seconds <= aim else "  MISSED"
    return f"{label:32}{seconds:10.3f}{aim:8.1f}{iterations:12}{value:>16}  {result.status}{said}"


if __name__ == "__main__":
    main()
