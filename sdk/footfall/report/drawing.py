"""Figures as SVG that stretches to any width: texts and dots keep their size, lines their weight.

A frame is an inner ``svg``. Ticks sit in it at percentages; the lines are in a view box of 1000 by
1000 that is stretched over it, with strokes that do not scale. A dot is a line of no length with
a round end.
"""

import json
from typing import Any

import numpy as np

from footfall.curves import Floats
from footfall.report.figures import TOGETHER, Figure, Series
from footfall.report.markup import Child, Markup, el, join
from footfall.report.phases import Band, Level

_SIZE = 1000
_LETTER = 0.011  # of a figure's width, on a screen that is not small


def frame(figure: Figure, ticks: tuple[int, int] = (10, 6), **box: Child) -> Markup:
    """The axes and lines of a figure in a box: attributes of the ``svg``."""
    lines = [_series(figure, item) for item in figure.series]
    mark = _mark(figure) if figure.mark else None
    data = el(
        "svg",
        *(_band(figure, band, index) for index, band in enumerate(figure.bands)),
        _level(figure, figure.mark[0], "mark") if figure.mark else None,
        *lines,
        class_="data",
        viewBox=f"0 0 {_SIZE} {_SIZE}",
        preserveAspectRatio="none",
        width="100%",
        height="100%",
    )
    names = _band_names(figure)
    return el("svg", _axes(figure, ticks), data, names, mark, overflow="visible", **box)


def pointer_data(figure: Figure) -> dict[str, Any]:
    """What the page's script needs to read values under the pointer."""
    return {
        "x": [figure.x.low, figure.x.high],
        "y": [figure.y.low, figure.y.high],
        "log": figure.y.log,
        "series": [
            {"breaks": _short(item.curve.breaks), "rows": _short(item.curve.coefficients)}
            for item in figure.series
        ],
    }


def script_json(document: Any) -> Markup:
    """JSON that cannot end the script element it stands in."""
    text = json.dumps(document, separators=(",", ":"), ensure_ascii=True, allow_nan=False)
    return Markup(text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026"))


def _axes(figure: Figure, ticks: tuple[int, int]) -> Markup:
    across, up = figure.x.ticks(ticks[0]), figure.y.ticks(ticks[1])
    rows = [(f"{100 * (1 - place):.3f}%", label) for place, label in up]
    columns = [(f"{100 * place:.3f}%", label) for place, label in across]
    if columns:
        columns[-1] = (columns[-1][0], columns[-1][1] + figure.unit)
    return join(
        *(el("line", class_="grid", x1="0", x2="100%", y1=y, y2=y) for y, _ in rows),
        el("line", class_="axis", x1="0", x2="100%", y1="100%", y2="100%"),
        *(el("text", label, class_="tick y", x="-8", y=y, dy="0.33em") for y, label in rows),
        *(el("line", class_="axis", x1=x, x2=x, y1="100%", y2="101.5%") for x, _ in columns),
        *(el("text", label, class_="tick x", x=x, y="100%", dy="18") for x, label in columns),
    )


def _series(figure: Figure, item: Series) -> Markup:
    dots = None
    if item.nodes is not None:
        most = max(len(other.nodes[0]) for other in figure.series if other.nodes is not None)
        few = "nodes" if most <= 120 else "nodes many"
        dots = el("path", class_=few, d=_dots(*_place(figure, *item.nodes)))
    return el(
        "g",
        *(_level(figure, level.value, "bound", level) for level in item.limits),
        el("path", class_="curve", d=_line(*_place(figure, item.time, item.value))),
        dots,
        class_=f"series {item.style}",
        data_name=item.label,
    )


def _level(figure: Figure, value: float, kind: str, span: Level | None = None) -> Markup:
    y = f"{_SIZE * (1 - float(figure.y.at(value))):.1f}"
    ends = (span.start, span.end) if span else (figure.x.low, figure.x.high)
    x1, x2 = (f"{_SIZE * float(figure.x.at(end)):.1f}" for end in ends)
    return el("line", class_=kind, x1=x1, x2=x2, y1=y, y2=y)


def _band(figure: Figure, band: Band, index: int) -> Markup:
    """A tint over a phase's time, and a line where it begins."""
    start, end = (_SIZE * float(figure.x.at(time)) for time in (band.start, band.end))
    tint = el(
        "rect",
        el("title", band.name),
        class_=f"band s{index % TOGETHER}",
        x=f"{start:.1f}",
        width=f"{max(end - start, 0.0):.1f}",
        height=_SIZE,
    )
    x = f"{start:.1f}"
    return join(tint, el("line", class_="boundary", x1=x, x2=x, y1=0, y2=_SIZE) if index else None)


def _band_names(figure: Figure) -> Markup:
    """The names of the phases that are wide enough for them, on top of the frame."""
    shares = [figure.x.at([band.start, band.end]) for band in figure.bands]
    return join(
        *(
            el("text", band.name, class_="phase", x=f"{50 * (start + end):.3f}%", y="0", dy="14")
            for band, (start, end) in zip(figure.bands, shares, strict=True)
            if end - start > _LETTER * len(band.name)
        )
    )


def _mark(figure: Figure) -> Markup | None:
    if figure.mark is None:
        return None
    y = f"{100 * (1 - float(figure.y.at(figure.mark[0]))):.3f}%"
    return el("text", figure.mark[1], class_="marked", x="100%", y=y, dy="-6")


def _place(figure: Figure, time: Floats, value: Floats) -> tuple[Floats, Floats]:
    return _SIZE * figure.x.at(time), _SIZE * (1 - figure.y.at(value))


def _line(x: Floats, y: Floats) -> str:
    parts, pen = [], "M"
    for across, down in zip(x.tolist(), y.tolist(), strict=True):
        if np.isfinite(down):
            parts.append(f"{pen}{across:.1f} {down:.1f}")
            pen = "L"
        else:
            pen = "M"
    return "".join(parts)


def _dots(x: Floats, y: Floats) -> str:
    pairs = zip(x.tolist(), y.tolist(), strict=True)
    return "".join(f"M{across:.1f} {down:.1f}h0" for across, down in pairs if np.isfinite(down))


def _short(values: Floats) -> Any:
    """Nine digits are enough to read; what is no number is null."""
    if values.ndim > 1:
        return [_short(row) for row in values]
    return [float(f"{value:.9g}") if np.isfinite(value) else None for value in values]
