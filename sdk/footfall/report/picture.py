"""The figures of a result as SVG files, for a README or a slide."""

from collections.abc import Mapping, Sequence
from typing import Any

from footfall.report.drawing import frame
from footfall.report.figures import Figure, mesh_errors, trajectories
from footfall.report.markup import Markup, asset, el
from footfall.report.modes import Sequences, keys, sequences_of, timeline
from footfall.report.motion import motion_of
from footfall.report.phases import COSTATES, IMPULSES
from footfall.report.scales import scientific
from footfall.report.strobe import strobe
from footfall.report.strobe import words as shown
from footfall.summary import VERDICTS, error_name, plural, published_mesh, words

_WIDTH, _LEFT, _RIGHT = 960, 76, 36
_HEAD, _GAP = 116, 74  # above the first frame, and between two frames


def render_svg(
    result: Mapping[str, Any], problem: Mapping[str, Any] | None = None, errors: bool = True
) -> str:
    """The trajectories, the modes and the mesh errors of a result as one standalone SVG.

    It follows the reader's light or dark scheme and loads nothing. Parameters as ``render``;
    ``errors`` false leaves the mesh errors out. Costates and impulses are left to the page.
    """
    found = trajectories(result["phases"], problem)
    figures = [figure for figure in found if figure.group not in (COSTATES, IMPULSES)]
    heights = [220 if index == 0 else 140 for index in range(len(figures))]
    refinement = result.get("mesh_refinement")
    steps = mesh_errors(refinement) if errors and refinement else None
    if steps:
        figures.append(steps)
        heights.append(150)
    said = f"{result['name']}: trajectory" + (" and mesh errors" if steps else "")
    modes = sequences_of(result)
    return compose(result["name"], _facts(result), figures, heights, said, modes)


def render_motion(result: Mapping[str, Any]) -> str | None:
    """Several frames of a result's motion over one another as one standalone SVG.

    As ``render_svg``; None where the result has no bodies to draw.
    """
    motion = motion_of(result)
    if motion is None:
        return None
    across = _WIDTH - _LEFT - _RIGHT
    drawn, height = strobe(motion, across, (_LEFT, _HEAD - 32))
    return _card(result["name"], shown(motion), [drawn], _HEAD + height, result["name"])


def compose(
    heading: str,
    facts: str,
    figures: Sequence[Figure],
    heights: Sequence[int],
    said: str = "",
    modes: Sequences | None = None,
) -> str:
    """Figures under one another as one standalone SVG.

    ``facts`` is the line below the heading, ``heights`` are those of the frames in px, ``said``
    is the picture's title for those who do not see it; ``modes`` go below the figures.
    """
    parts, top = [], _HEAD
    for figure, height in zip(figures, heights, strict=True):
        parts += [*_legend(figure, top - 18), _frame(figure, top, height)]
        top += height + _GAP
    if modes is not None:
        box = {"x": _LEFT, "y": top, "width": _WIDTH - _LEFT - _RIGHT}
        drawn, height = timeline(modes, **box)
        parts += [*_mode_legend(modes, top - 18), drawn]
        top += height + _GAP
    return _card(heading, facts, parts, top - _GAP + 52, said or heading)


def _card(heading: str, facts: str, parts: Sequence[Markup], total: float, said: str) -> Markup:
    """The parts under a heading, on paper."""
    total = round(total)
    return el(
        "svg",
        el("title", said),
        el("style", Markup(asset("figure.css"))),
        el("rect", class_="card", width=_WIDTH - 1, height=total - 1, x=0.5, y=0.5, rx=10),
        el("text", heading, class_="heading", x=_LEFT, y=40),
        el("text", facts, class_="tick start", x=_LEFT, y=62),
        *parts,
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {_WIDTH} {total}",
        width=_WIDTH,
        height=total,
        role="img",
    )


def _frame(figure: Figure, top: int, height: int) -> Markup:
    across = _WIDTH - _LEFT - _RIGHT
    return frame(
        figure, (10, 4 if height < 200 else 6), x=_LEFT, y=top, width=across, height=height
    )


def _facts(result: Mapping[str, Any]) -> str:
    if result.get("kind") == "simulation":
        return f"{words(result['status'])} \N{MIDDLE DOT} {result['message']}"
    mesh = published_mesh(result)
    parts = [words(result["status"]), f"objective {scientific(result['objective'], 8)}"]
    if mesh:
        parts.append(plural(mesh["segments"], "segment"))
        parts.append(f"{error_name(result)} {scientific(mesh['max_error'], 2)}")
    parts.append(VERDICTS[result["certificate"]["verdict"]])
    return " \N{MIDDLE DOT} ".join(parts)


def _legend(figure: Figure, y: int) -> list[Markup]:
    """The title at the left; the keys from the right end, by estimated width."""
    parts = [el("text", figure.title, class_="caption", x=_LEFT, y=y)]
    x = float(_WIDTH - _RIGHT)
    for item in reversed(figure.series):
        x -= 6.6 * len(item.label)
        parts.append(el("text", item.label, class_="tick start", x=f"{x:.1f}", y=y))
        x -= 24
        line = el("line", class_="curve", x1=f"{x:.1f}", x2=f"{x + 18:.1f}", y1=y - 4, y2=y - 4)
        parts.append(el("g", line, class_=f"series {item.style}"))
        x -= 18
    return parts


def _mode_legend(modes: Sequences, y: int) -> list[Markup]:
    """As that of a figure."""
    parts = [el("text", "Modes", class_="caption", x=_LEFT, y=y)]
    x = float(_WIDTH - _RIGHT)
    for name, swatch in reversed(keys(modes)):
        x -= 6.6 * len(name)
        parts.append(el("text", name, class_="tick start", x=f"{x:.1f}", y=y))
        x -= 28
        parts.append(el("svg", swatch, x=f"{x:.1f}", y=y - 10, width=22, height=12))
        x -= 18
    return parts
