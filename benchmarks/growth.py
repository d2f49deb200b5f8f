"""How time grows: with the segments of the cart-pole, with the states of a chain of masses.

Run: python -m benchmarks.growth. Prints the fitted exponents and draws docs/images/growth.svg.
"""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import examples
from benchmarks.chain import chain
from footfall.report.figures import Figure, points
from footfall.report.picture import compose
from footfall.report.scales import logarithmic
from schemas.reading import read_problem
from solver import solve

SEGMENTS = (25, 50, 100, 200, 400, 800, 1600, 3200)
MASSES = (1, 2, 4, 8, 16, 30)
CHAIN_SEGMENTS = 200
PATIENCE = 20.0
"""Seconds for one solve; what takes longer is told as such and left out of the fit."""

FITTED_FROM = {"segments": 100, "states": 4}
"""Below, what every problem costs hides the growth."""

PICTURE = Path(__file__).parents[1] / "docs" / "images" / "growth.svg"


@dataclass(frozen=True)
class Point:
    """One size: seconds to build and solve, of those in the NLP solver, and its iterations."""

    size: int
    seconds: float
    nlp: float
    iterations: int
    status: str


def main() -> None:
    """Print the tables and draw the picture."""
    sweeps = {
        "Hermite-Simpson": ("segments", [_of_segments("hermite_simpson", n) for n in SEGMENTS]),
        "Radau, 4 points": ("segments", [_of_segments("radau", n) for n in SEGMENTS]),
        "chain of masses": ("states", [_of_masses(n) for n in MASSES]),
    }
    for title, (what, sweep) in sweeps.items():
        _show(title, what, sweep)
    figures = list(_figures(sweeps))
    facts = "build and solve, without certificate; logarithmic axes; best of two"
    PICTURE.write_text(compose("How time grows", facts, figures, [240] * len(figures)) + "\n")
    print(f"\ndrawn: {PICTURE.relative_to(Path(__file__).parents[1])}")


def _of_segments(kind: str, segments: int) -> Point:
    method = {"kind": kind, "segments": segments}
    return _measured(segments, examples.load("cart_pole") | {"method": method})


def _of_masses(masses: int) -> Point:
    return _measured(2 * masses, chain(masses, CHAIN_SEGMENTS))


def _measured(size: int, document: dict[str, Any]) -> Point:
    """The best of two, but only one where it takes long."""
    problem = read_problem(document | {"refinement": None, "limits": {"seconds": PATIENCE}})
    began, found = time.perf_counter(), []
    for _ in range(2):
        result = solve(problem)
        seconds = result.timing.build + result.timing.solve
        solver = result.solver
        found.append(Point(size, seconds, solver.seconds, solver.iterations, result.status))
        if time.perf_counter() - began > 3.0:
            break
    return min(found, key=lambda point: point.seconds)


def exponent(sweep: Sequence[Point], least: int, name: str) -> float:
    """The slope of log(seconds) over log(size), by least squares; nan with less than two points."""
    kept = [p for p in sweep if p.size >= least and p.status != "time_limit"]
    if len(kept) < 2:
        return float("nan")
    sizes, seconds = ([getattr(p, key) for p in kept] for key in ("size", name))
    return float(np.polyfit(np.log(sizes), np.log(seconds), 1)[0])


def _show(title: str, what: str, sweep: Sequence[Point]) -> None:
    print(f"\n{title}\n{what:>10}{'build+solve ms':>16}{'NLP ms':>12}{'iterations':>12}  status")
    for p in sweep:
        print(f"{p.size:10}{p.seconds * 1e3:16.1f}{p.nlp * 1e3:12.1f}{p.iterations:12}  {p.status}")
    least = FITTED_FROM[what]
    whole, alone = (exponent(sweep, least, name) for name in ("seconds", "nlp"))
    print(f"exponent from {least} {what}: {whole:.2f} in all, {alone:.2f} in the NLP solver")


def _figures(sweeps: dict[str, tuple[str, list[Point]]]) -> Iterator[Figure]:
    """Seconds over size, a figure for each kind of size."""
    for what, least in FITTED_FROM.items():
        chosen = [(title, sweep) for title, (kind, sweep) in sweeps.items() if kind == what]
        series = [
            points(
                f"{title}: exponent {exponent(sweep, least, 'seconds'):.2f}",
                f"s{index}",
                np.array([float(p.size) for p in sweep]),
                [p.seconds for p in sweep],
            )
            for index, (title, sweep) in enumerate(chosen)
        ]
        sizes = [float(p.size) for _, sweep in chosen for p in sweep]
        seconds = [p.seconds for _, sweep in chosen for p in sweep]
        yield Figure(
            f"Seconds over {what}", series, logarithmic(sizes), logarithmic(seconds), unit=""
        )


if __name__ == "__main__":
    main()
