"""What a sweep saves by keeping the functions of its first point: build and solve, side by side.

Run: python -m benchmarks.sweep. One mass is swept, on the example's own first mesh or on all that
refinement asks for: once with all functions built anew, once with those of the points before. The
first point counts in both.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import examples
from benchmarks.aims import Clock
from schemas.events import EngineEvent
from schemas.problem import Problem
from schemas.reading import read_problem
from solver import solve
from solver.nlp.kept import forget

POINTS = 20


@dataclass(frozen=True)
class Swept:
    """An example and the parameter that is swept, from its own value up by a twentieth."""

    example: str
    parameter: str
    refined: bool = False


SWEPT = (
    Swept("five_link_biped", "m_torso"),
    Swept("five_link_biped_floating", "m_torso"),
    Swept("cart_pole", "m2"),
    Swept("cart_pole", "m2", refined=True),
)


class _Forgetful(Clock):
    """Has all built anew, on every mesh."""

    def __call__(self, event: EngineEvent) -> None:
        """Forget where a stage begins."""
        forget()
        super().__call__(event)


@dataclass(frozen=True)
class Spent:
    """Processor seconds to build, and to build and solve, over all points; their objectives."""

    build: float
    whole: float
    objectives: list[float]


def main() -> None:
    """Print the table."""
    print(f"\n{POINTS} points of a sweep, processor milliseconds a point")
    print(f"{'':44}{'build':>8}{'anew':>8}{'ratio':>7}{'+ solve':>10}{'anew':>8}{'ratio':>7}")
    for swept in SWEPT:
        print(_row(swept))


def _row(swept: Swept) -> str:
    points = list(_points(swept))
    _spent(points[:1], Clock)  # what is loaded on first use
    anew, kept = _spent(points, _Forgetful), _spent(points, Clock)
    pairs = zip(anew.objectives, kept.objectives, strict=True)
    apart = max(abs(one - other) / (1 + abs(one)) for one, other in pairs)
    title = f"{swept.example}, {swept.parameter}{', all meshes' if swept.refined else ''}"
    columns = [
        f"{1e3 * one / POINTS:{width}.1f}{1e3 * other / POINTS:8.1f}{other / one:7.2f}"
        for one, other, width in ((kept.build, anew.build, 8), (kept.whole, anew.whole, 10))
    ]
    return f"{title:44}{''.join(columns)}   objectives apart by {apart:.0e}"


def _points(swept: Swept) -> Iterator[Problem]:
    document: dict[str, Any] = examples.load(swept.example)
    parameters = document["phases"][0]["system"]["parameters"]
    own = parameters[swept.parameter]
    for number in range(POINTS):
        parameters[swept.parameter] = own * (1.001 + 0.05 * number / POINTS)
        yield read_problem(document if swept.refined else document | {"refinement": None})


def _spent(points: Sequence[Problem], make: type[Clock]) -> Spent:
    """All points, one after another; the first one begins with nothing kept."""
    forget()
    clocks, objectives = [], []
    for point in points:
        clocks.append(make())
        found = solve(point, on_event=clocks[-1]).objective
        objectives.append(float("nan") if found is None else found)
    build = sum(clock.spent["build"] for clock in clocks)
    return Spent(build, sum(clock.seconds for clock in clocks), objectives)


if __name__ == "__main__":
    main()
