"""Random starts on the ice, and which sequence of phases is best from each (004).

``python -m benchmarks.reproduce.scenarios --scenarios 20 --seed 0``
"""

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from random import Random
from typing import Any

import examples
from benchmarks.reproduce.judge import SOLVED
from schemas.reading import read_problem
from solver import solve

SEQUENCES = ("sli_str", "sli_stl_str")
"""Those that begin on the ice."""

METHOD = {"kind": "hermite_simpson", "segments": 15, "control": "linear"}
"""Coarse: sequences differ by much more than meshes do."""

Start = Mapping[str, float]


@dataclass(frozen=True)
class Choice:
    """What each sequence costs from a start: the least integral of work, None where it cannot."""

    start: Start
    work: Mapping[str, float | None]

    @property
    def best(self) -> str | None:
        """The cheapest sequence that is possible."""
        possible = {name: cost for name, cost in self.work.items() if cost is not None}
        return min(possible, key=lambda name: possible[name]) if possible else None


def random_start(random: Random) -> Start:
    """A start as the seed draws it (``randState``): sinking, the leg at its full length."""
    x = 0.3 + 0.4 * random.random()
    speed, ahead = 0.5 * random.random(), 0.2 * random.random()
    return {
        "xtoe": x + ahead,
        "xtoedot": speed,
        "x": x,
        "xdot": speed,
        "y": sqrt(1 - ahead**2),
        "ydot": -0.4 * random.random(),
        "ra": 1.0,
        "radot": 0.0,
    }


def scenarios(count: int, seed: int, tries: int = 3) -> Iterator[Choice]:
    """So many random starts, each with its choice; the same for the same seed."""
    random = Random(seed)  # noqa: S311 - scenarios, no secrets
    for _ in range(count):
        yield choose(random_start(random), tries)


def choose(start: Start, tries: int = 3) -> Choice:
    """Every sequence from one start, each from a few guesses."""
    return Choice(start, {name: _least_work(name, start, tries) for name in SEQUENCES})


def problem(sequence: str, start: Start, seed: int) -> dict[str, Any]:
    """The example of a sequence from another start; seed 0 keeps its own guess."""
    document = examples.load(f"slip_{sequence}")
    document["phases"][0]["initial"] = dict(start)
    document["refinement"] = None
    document["method"] = METHOD
    document["solver"] = {"max_iterations": 500}
    for stage in document["stages"]:
        stage["refinement"] = None
    if seed:
        document["guess"] = {"kind": "random", "seed": seed}
        for phase in document["phases"]:
            phase.pop("guess", None)
    return document


def _least_work(sequence: str, start: Start, tries: int) -> float | None:
    found = []
    for seed in range(tries):
        solution = solve(read_problem(problem(sequence, start, seed)))
        if solution.status in SOLVED and solution.objective is not None:
            found.append(solution.objective)
    return min(found, default=None)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a line for each scenario."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.reproduce.scenarios")
    parser.add_argument("--scenarios", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    print(
        f"{'x':>6}{'xdot':>7}{'ahead':>7}{'ydot':>7}",
        *(f"{name:>12}" for name in SEQUENCES),
        " best",
    )
    for choice in scenarios(options.scenarios, options.seed):
        start = choice.start
        numbers = (start["x"], start["xdot"], start["xtoe"] - start["x"], start["ydot"])
        costs = ("impossible" if cost is None else f"{cost:.6f}" for cost in choice.work.values())
        where = f"{numbers[0]:6.3f}" + "".join(f"{number:7.3f}" for number in numbers[1:])
        print(where, *(f"{cost:>12}" for cost in costs), f" {choice.best or 'none'}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
