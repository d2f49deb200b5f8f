"""What an NLP iteration costs through contact: over the steps, and over the contact points.

Run: python -m benchmarks.contact_growth. Processor time between two iterations, the median over one
pass at one relaxation. Prints the fitted exponents and draws docs/images/contact_growth.svg.
"""

import statistics
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

import examples
from benchmarks.rocker import rocker
from footfall.report.figures import Figure, points
from footfall.report.picture import compose
from footfall.report.scales import Scale, logarithmic
from schemas.events import EngineEvent, NlpIteration
from schemas.reading import read_problem
from solver import solve

STEPS = (10, 20, 40, 80, 160)
CONTACTS = (1, 2, 4, 8, 16)
WALKER = "spring_flamingo"
CONTACT_STEPS = 40
"""Of the plank, while its points become more."""

ONE_PASS = {"schedule": [0.01], "polish": False}
ITERATIONS = 60
"""Then it is stopped: the cost of an iteration hardly changes along a solve."""

FITTED_FROM = {"steps": 20, "contacts": 2}
"""Below, what every iteration costs hides the growth."""

MARGIN = 1.5
"""Times the sizes, at both sides of the picture."""

PICTURE = Path(__file__).parents[1] / "docs" / "images" / "contact_growth.svg"


@dataclass(frozen=True)
class Point:
    """One size: the program's variables and rows, and the processor seconds of an iteration."""

    size: int
    seconds: float
    iterations: int
    variables: int
    rows: int


@dataclass
class Beat:
    """Takes the processor time at every iteration."""

    at: list[float] = field(default_factory=list)

    def __call__(self, event: EngineEvent) -> None:
        """Take note; of what is no iteration, none."""
        if isinstance(event, NlpIteration):
            self.at.append(time.process_time())

    @property
    def median(self) -> float:
        """Of the seconds between two iterations; nan with less than two."""
        gaps = [after - before for before, after in pairwise(self.at)]
        return statistics.median(gaps) if gaps else float("nan")


def main() -> None:
    """Print the tables and draw the picture."""
    sweeps = {f"plank on {CONTACTS[2]} points": ("steps", [_plank(CONTACTS[2], n) for n in STEPS])}
    if WALKER in examples.names():
        sweeps["Spring Flamingo"] = ("steps", [_walker(n) for n in STEPS])
    else:
        print(f"NOT MEASURED, not in the gallery: {WALKER}")
    plank = [_plank(n, CONTACT_STEPS, n) for n in CONTACTS]
    sweeps[f"plank, {CONTACT_STEPS} steps"] = ("contacts", plank)
    for title, (what, sweep) in sweeps.items():
        show(title, what, sweep)
    figures = list(_figures(sweeps))
    facts = "processor seconds of one NLP iteration through contact; logarithmic axes; medians"
    drawn = compose("What an iteration costs", facts, figures, [240] * len(figures))
    PICTURE.write_text(drawn + "\n")
    print(f"\ndrawn: {PICTURE.relative_to(Path(__file__).parents[1])}")


def _plank(contacts: int, steps: int, size: int = 0) -> Point:
    return measured(size or steps, rocker(contacts, steps))


def _walker(steps: int) -> Point:
    document = examples.load(WALKER)
    return measured(steps, document | {"method": document["method"] | {"segments": steps}})


def measured(size: int, document: Mapping[str, Any]) -> Point:
    """One pass of the homotopy, cut short."""
    alone = {
        "method": document["method"] | {"relaxation": ONE_PASS},
        "refinement": None,
    }
    beat = Beat()
    ended = solve(
        read_problem({**document, **alone}),
        on_event=beat,
        should_stop=lambda: len(beat.at) > ITERATIONS,
    ).solver
    return Point(size, beat.median, len(beat.at), ended.variables or 0, ended.constraints or 0)


def exponent(sweep: Sequence[Point], least: int) -> float:
    """The slope of log(seconds) over log(size), by least squares; nan with less than two points."""
    kept = [p for p in sweep if p.size >= least and p.seconds > 0]
    if len(kept) < 2:
        return float("nan")
    sizes, seconds = [p.size for p in kept], [p.seconds for p in kept]
    return float(np.polyfit(np.log(sizes), np.log(seconds), 1)[0])


def show(title: str, what: str, sweep: Sequence[Point]) -> None:
    """Print one table, and its exponent."""
    head = f"{what:>10}{'ms an iteration':>18}{'iterations':>12}{'variables':>11}{'rows':>8}"
    print(f"\n{title}\n{head}")
    for p in sweep:
        print(f"{p.size:10}{p.seconds * 1e3:18.2f}{p.iterations:12}{p.variables:11}{p.rows:8}")
    least = FITTED_FROM[what]
    print(f"exponent from {least} {what}: {exponent(sweep, least):.2f}")


def _figures(sweeps: Mapping[str, tuple[str, Sequence[Point]]]) -> Iterator[Figure]:
    """Seconds over size, a figure for each kind of size."""
    for what, least in FITTED_FROM.items():
        chosen = [(title, sweep) for title, (kind, sweep) in sweeps.items() if kind == what]
        series = [
            points(
                f"{title}: exponent {exponent(sweep, least):.2f}",
                f"s{index}",
                np.array([float(p.size) for p in sweep]),
                [p.seconds for p in sweep],
            )
            for index, (title, sweep) in enumerate(chosen)
        ]
        sizes = [float(p.size) for _, sweep in chosen for p in sweep]
        seconds = [p.seconds for _, sweep in chosen for p in sweep]
        title = f"Seconds an iteration over {what}"
        across = Scale(min(sizes) / MARGIN, max(sizes) * MARGIN, log=True)
        yield Figure(title, series, across, logarithmic(seconds), unit="")


if __name__ == "__main__":
    main()
