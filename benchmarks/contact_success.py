"""How often contact-implicit solves succeed, from how many guesses, and in what time.

Run: python -m benchmarks contact_success; python -m benchmarks.contact_success --seeds 5 for a few
guesses of each. Each example is solved from its own guess with smooth noise of as many seeds, on
both cores; seconds are those of the processor, from the document to the certificate.
"""

import argparse
import os
import statistics
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from typing import Any

import examples
from schemas.reading import read_problem
from schemas.results import ModeSequence, Solution, SolutionStatus
from solver import solve

SOLVED = (SolutionStatus.CONVERGED, SolutionStatus.CERTIFICATE_FAILED, SolutionStatus.MESH_LIMIT)
"""Optimal on the mesh that is published; only the first of them is certified, too."""


@dataclass(frozen=True)
class Case:
    """An example and what is promised of it.

    Attributes
    ----------
    example
        Its name in the gallery.
    aim
        How many of how many guesses are to succeed.
    spread
        The noise about the example's own guess, relative to the widths of bounds.
    seconds
        The median that is aimed at.
    residual
        The complementarity residual that a success may have, SI units.
    """

    example: str
    aim: tuple[int, int]
    spread: float
    seconds: float
    residual: float = 1e-8


@dataclass(frozen=True)
class Ended:
    """How one guess ended. ``modes`` are the modes in order, as text; empty where none touched."""

    status: str
    objective: float | None
    residual: float | None
    seconds: float
    modes: str


CASES = (
    Case("stiction_block", (20, 20), 0.15, 0.2),
    Case("finger_no_gravity", (95, 100), 0.15, 1.0),
    Case("finger_no_gravity_four_seconds", (95, 100), 0.15, 6.0),
    Case("gripper", (18, 20), 0.15, 10.0, residual=1e-6),
    Case("spring_flamingo", (18, 20), 0.15, 25.0),
)


def main(seeds: int | None = None) -> None:
    """Print the counts, and which examples are not there."""
    there = set(examples.names())
    print(
        "\nsuccess of contact-implicit solves: optimal, certified, strictly complementary, "
        "something touches"
    )
    print(HEAD)
    with ProcessPoolExecutor(min(2, os.cpu_count() or 1)) as pool:
        for case in CASES:
            if case.example in there:
                count = seeds or case.aim[1]
                runs = [pool.submit(run, case, seed) for seed in range(count)]
                print(row(case, [one.result() for one in runs]), flush=True)
    if missing := [case.example for case in CASES if case.example not in there]:
        print(f"NOT MEASURED, not in the gallery: {', '.join(missing)}")


def run(case: Case, seed: int) -> Ended:
    """Solve a case from one guess; seed 0 is the example's own."""
    began = time.process_time()
    solution = solve(read_problem(noisy(examples.load(case.example), seed, case.spread)))
    return ended(solution, time.process_time() - began)


def noisy(document: dict[str, Any], seed: int, spread: float) -> dict[str, Any]:
    """The document with noise about its guess, also about those of its phases; from one guess."""
    known = {key: value for key, value in document.items() if key != "multistart"}
    if seed == 0:
        return known
    phases = [
        phase | {"guess": _about(phase["guess"], seed, spread)} if phase.get("guess") else phase
        for phase in known["phases"]
    ]
    return known | {"guess": _about(known.get("guess"), seed, spread), "phases": phases}


def _about(guess: dict[str, Any] | None, seed: int, spread: float) -> dict[str, Any]:
    noise = {"kind": "random", "seed": seed, "spread": spread}
    if guess and guess["kind"] == "random":
        guess = guess.get("about")
    return noise | ({"about": guess} if guess else {})


def ended(solution: Solution, seconds: float) -> Ended:
    """What counts of a solution."""
    told = solution.complementarity
    return Ended(
        str(solution.status),
        solution.objective,
        None if told is None else told.residual,
        seconds,
        _modes(solution.mode_sequence),
    )


def _modes(sequence: ModeSequence | None) -> str:
    """The modes in order without their times; nothing where no contact touches."""
    if sequence is None:
        return ""
    words = [
        ",".join(f"{name}={how}" for name, how in sorted(mode.contacts.items()))
        for mode in sequence.modes
    ]
    touching = any(
        not name.startswith("limit.") for mode in sequence.modes for name in mode.contacts
    )
    return " | ".join(words) if touching else ""


def succeeded(case: Case, one: Ended) -> bool:
    """Whether a guess led to a certified solution that touches, with contacts that are strict."""
    return one.status == SolutionStatus.CONVERGED and solved(case, one)


def solved(case: Case, one: Ended) -> bool:
    """Whether it led to an optimum that touches, with contacts that are strict."""
    strict = one.residual is not None and one.residual <= case.residual
    return one.status in map(str, SOLVED) and strict and bool(one.modes)


HEAD = (
    f"{'':32}{'success':>12}{'aim':>10}{'optimal':>11}{'median s':>10}{'aim':>7}"
    f"{'residual':>10}{'sequences':>11}{'best':>12}{'median':>12}"
)


def row(case: Case, runs: Sequence[Ended]) -> str:
    """One line of the table; residuals and objectives are those of the successes."""
    good = [one for one in runs if succeeded(case, one)]
    optimal = sum(solved(case, one) for one in runs)
    seconds = statistics.median(one.seconds for one in runs)
    values = sorted(one.objective for one in good if one.objective is not None)
    residual = max((one.residual for one in good if one.residual is not None), default=None)
    middle = statistics.median(values) if values else None
    share = len(good) / len(runs)
    missed = share < case.aim[0] / case.aim[1] or seconds > case.seconds
    cells = (
        f"{case.example:32}{f'{len(good)} of {len(runs)}':>12}{f'{case.aim[0]}/{case.aim[1]}':>10}",
        f"{optimal:11}{seconds:10.2f}{case.seconds:7.1f}{_number(residual, 2):>10}",
        f"{len({one.modes for one in good}):11}{_number(values[0] if values else None, 6):>12}",
        f"{_number(middle, 6):>12}{'  MISSED' if missed else ''}",
        *_failures(case, runs),
    )
    return "".join(cells)


def _failures(case: Case, runs: Sequence[Ended]) -> Iterator[str]:
    """How those ended that did not succeed."""
    ways = [_why(case, one) for one in runs if not succeeded(case, one)]
    for way in dict.fromkeys(ways):
        yield f"\n    {ways.count(way)} {way}"


def _why(case: Case, one: Ended) -> str:
    if one.status not in map(str, SOLVED):
        return one.status.replace("_", " ")
    if one.residual is None or one.residual > case.residual:
        return "not strictly complementary"
    return "nothing touches" if not one.modes else "not certified"


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}g}"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, help="guesses of each example")
    main(parser.parse_args().seeds)
