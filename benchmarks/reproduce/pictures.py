"""The hopper's trajectories in the colour key of 004, as SVG.

Dark blue: slide. Green: first stick. Red: second stick. Light blue: flight. Black: the toe.
Green ring: landing. Blue ring: takeoff. The dots are evenly spaced in time; the leg is drawn in
the starting state.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import examples
from benchmarks.reproduce.tables.slip import SEQUENCES
from footfall.curves import Curves
from footfall.report.markup import Markup, el, join
from schemas.reading import read_problem
from schemas.results import PhaseResult, Solution
from solver import solve

Floats = NDArray[np.float64]

SLIDE, STICKS, FLIGHT, TOE = "#00208f", ("#2a9d3a", "#d1352b"), "#7cc4f2", "#000000"
LANDING, TAKEOFF = "#2fd04b", "#2f6bff"
STEP = 0.05
"""Seconds between dots."""

_SCALE, _MARGIN, _PANEL = 170.0, 20.0, (-0.85, 1.65, -0.1, 1.35)
"""Pixels per metre, and the edges of what is shown of the world: left, right, bottom, top."""


def draw_hoppers(path: Path) -> None:
    """Solve the four sequences and draw them below each other."""
    solutions = {name: solve(read_problem(examples.load(f"slip_{name}"))) for name in SEQUENCES}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(draw(solutions), encoding="utf-8")


def draw(solutions: Mapping[str, Solution]) -> str:
    """One panel for each sequence of phases, two in a row."""
    left, right, bottom, top = _PANEL
    width, height = _SCALE * (right - left), _SCALE * (top - bottom) + _MARGIN
    panels = [
        el(
            "g",
            _panel(name, solution),
            transform=f"translate({(n % 2) * width:g} {n // 2 * height:g})",
        )
        for n, (name, solution) in enumerate(solutions.items())
    ]
    size = {"width": f"{2 * width:g}", "height": f"{(len(panels) + 1) // 2 * height:g}"}
    box = f"0 0 {size['width']} {size['height']}"
    white = el("rect", width="100%", height="100%", fill="white")
    return el("svg", white, *panels, xmlns="http://www.w3.org/2000/svg", viewBox=box, **size)


def _panel(name: str, solution: Solution) -> Markup:
    title = el("text", name.replace("_", "-"), x="8", y="18", font_family="sans-serif")
    parts = [title, _line([(-0.85, 0), (1.65, 0)], "#999"), _line([(0, 0), (1, 0)], FLIGHT, 5)]
    sticks = iter(STICKS)
    for phase in solution.phases:
        stands, slides = (
            "xtoe" in phase.curves["states"].coefficients,
            "xtoedot" in phase.curves["states"].coefficients,
        )
        colour = SLIDE if slides else next(sticks) if stands else FLIGHT
        parts.extend(_phase(phase, colour))
    first = _at(solution.phases[0], np.array([solution.phases[0].knots[0]]))
    hip, toe = (first["x"][0], first["y"][0]), (first["xtoe"][0], 0.0)
    parts.extend((_line([toe, hip], "#555", 2), _dot(hip, "#555", 5)))
    parts.extend(_events(solution))
    return join(*parts)


def _phase(phase: PhaseResult, colour: str) -> Iterator[Markup]:
    """The hip's way and its dots; the toe's."""
    start, end = phase.knots[0], phase.knots[-1]
    way = _at(phase, np.linspace(start, end, 60))
    yield _line(list(zip(way["x"], way["y"], strict=True)), colour, 2)
    dots = _at(phase, np.arange(np.ceil(start / STEP), end / STEP) * STEP)
    for x, y in zip(dots["x"], dots["y"], strict=True):
        yield _dot((x, y), colour, 2.6)
    for x in dots.get("xtoe", ()):
        yield _dot((x, 0.0), TOE, 2.2)


def _events(solution: Solution) -> Iterator[Markup]:
    """Rings at the ends of flights."""
    for phase in solution.phases:
        if "xtoe" not in phase.curves["states"].coefficients:
            ends = _at(phase, np.array([phase.knots[0], phase.knots[-1]]))
            for which, colour in enumerate((TAKEOFF, LANDING)):
                yield _ring((ends["x"][which], ends["y"][which]), colour)


def _at(phase: PhaseResult, times: Floats) -> dict[str, Floats]:
    return Curves.from_dict(phase.curves["states"].model_dump()).sample(times)


def _place(point: tuple[float, float]) -> tuple[str, str]:
    left, _, _, top = _PANEL
    return f"{_SCALE * (point[0] - left):.1f}", f"{_SCALE * (top - point[1]):.1f}"


def _line(points: list[tuple[float, float]], colour: str, width: float = 1) -> Markup:
    along = " ".join(",".join(_place(point)) for point in points)
    return el("polyline", points=along, fill="none", stroke=colour, stroke_width=f"{width:g}")


def _dot(point: tuple[float, float], colour: str, radius: float) -> Markup:
    x, y = _place(point)
    return el("circle", cx=x, cy=y, r=f"{radius:g}", fill=colour)


def _ring(point: tuple[float, float], colour: str) -> Markup:
    x, y = _place(point)
    return el("circle", cx=x, cy=y, r="7", fill="none", stroke=colour, stroke_width="3")
