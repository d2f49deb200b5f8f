"""Maps over two quantities as SVG: a coloured cell for each pair of values."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from footfall.report.markup import Markup, el, join

Floats = NDArray[np.float64]

CELL, LEFT, TOP, RIGHT, BOTTOM = 13.0, 62.0, 34.0, 96.0, 50.0
FONT = {"font_family": "sans-serif", "font_size": "11"}


@dataclass(frozen=True)
class Axis:
    """Values of the cells, and which of them are written."""

    title: str
    values: Floats
    ticks: Sequence[float]

    def place(self, value: float) -> float:
        """Where a value is, in cells: cells are equal steps of the logarithm."""
        logs = np.log(self.values)
        return float((np.log(value) - logs[0]) / (logs[1] - logs[0])) + 0.5


@dataclass(frozen=True)
class Heat:
    """A map: ``cells`` (y, x), how to colour a value, and the values of the legend in words."""

    title: str
    x: Axis
    y: Axis
    cells: Floats
    colour: Callable[[float], str]
    legend: Sequence[tuple[float, str]]

    @property
    def size(self) -> tuple[float, float]:
        """Pixels."""
        rows, columns = self.cells.shape
        return LEFT + CELL * columns + RIGHT, TOP + CELL * rows + BOTTOM

    def draw(self) -> Markup:
        """The map with its axes and legend."""
        return join(*self._cells(), *self._x_axis(), *self._y_axis(), *self._legend())

    def _cells(self) -> list[Markup]:
        rows, columns = self.cells.shape
        parts = [el("text", self.title, x=f"{LEFT:g}", y="20", font_weight="bold", **FONT)]
        for row in range(rows):
            for column in range(columns):
                place = self._corner(column, row)
                size = {"width": f"{CELL + 0.3:g}", "height": f"{CELL + 0.3:g}"}
                fill = self.colour(float(self.cells[row, column]))
                parts.append(el("rect", **place, **size, fill=fill))
        return parts

    def _corner(self, column: float, row: float) -> dict[str, str]:
        rows = self.cells.shape[0]
        return {"x": f"{LEFT + CELL * column:g}", "y": f"{TOP + CELL * (rows - 1 - row):g}"}

    def _x_axis(self) -> list[Markup]:
        rows, columns = self.cells.shape
        low = TOP + CELL * rows
        middle = {"text_anchor": "middle", **FONT}
        parts = [
            el(
                "text",
                f"{tick:g}",
                x=f"{LEFT + CELL * self.x.place(tick):g}",
                y=f"{low + 16:g}",
                **middle,
            )
            for tick in self.x.ticks
        ]
        centre = f"{LEFT + CELL * columns / 2:g}"
        return [*parts, el("text", self.x.title, x=centre, y=f"{low + 36:g}", **middle)]

    def _y_axis(self) -> list[Markup]:
        rows = self.cells.shape[0]
        end = {"text_anchor": "end", **FONT}
        parts = []
        for tick in self.y.ticks:
            y = TOP + CELL * (rows - self.y.place(tick)) + 4
            parts.append(el("text", f"{tick:g}", x=f"{LEFT - 6:g}", y=f"{y:g}", **end))
        turn = f"translate(16 {TOP + CELL * rows / 2:g}) rotate(-90)"
        return [*parts, el("text", self.y.title, transform=turn, text_anchor="middle", **FONT)]

    def _legend(self) -> list[Markup]:
        x = LEFT + CELL * self.cells.shape[1] + 12
        parts = []
        for row, (value, words) in enumerate(self.legend):
            y = TOP + 18 * row
            square = {"x": f"{x:g}", "y": f"{y:g}", "width": "13", "height": "13"}
            parts.append(el("rect", **square, fill=self.colour(value), stroke="#888"))
            parts.append(el("text", words, x=f"{x + 18:g}", y=f"{y + 11:g}", **FONT))
        return parts


def page(maps: Sequence[Heat]) -> str:
    """Maps side by side."""
    parts, left, height = [], 0.0, 0.0
    for one in maps:
        parts.append(el("g", one.draw(), transform=f"translate({left:g} 0)"))
        left, height = left + one.size[0], max(height, one.size[1])
    size = {"width": f"{left:g}", "height": f"{height:g}"}
    white = el("rect", width="100%", height="100%", fill="white")
    box = f"0 0 {left:g} {height:g}"
    return el("svg", white, *parts, xmlns="http://www.w3.org/2000/svg", viewBox=box, **size)


def ramp(colours: Sequence[str], low: float, high: float) -> Callable[[float], str]:
    """Colours in equal steps between two values; white where there is none."""
    table = np.array([[int(one[i : i + 2], 16) for i in (1, 3, 5)] for one in colours], dtype=float)

    def colour(value: float) -> str:
        if not np.isfinite(value):
            return "#ffffff"
        place = np.clip((value - low) / (high - low), 0, 1) * (len(table) - 1)
        mixed = [np.interp(place, np.arange(len(table)), table[:, i]) for i in range(3)]
        return "#" + "".join(f"{round(float(part)):02x}" for part in mixed)

    return colour
