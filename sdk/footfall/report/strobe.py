"""Several frames of a motion over one another, as SVG: the old ones pale, the last one strong."""

from collections.abc import Iterator

import numpy as np

from footfall.curves import Floats
from footfall.report.markup import Markup, el, join
from footfall.report.motion import Box, Clip, Motion
from footfall.report.scales import scientific

FRAMES = 9
_TALLEST = 0.62  # of the picture's width
_LEAST = 0.2
_SPOKEN = f"{FRAMES} frames of the motion over one another"
_SEEN = 0.02  # of a body's size: shorter arrows are left out
_SPRING = 12  # bends of a spring that is drawn


def strobe(
    motion: Motion, width: float, corner: tuple[float, float] | None = None
) -> tuple[Markup, float]:
    """The picture, and its height where it is ``width`` wide, in px.

    With a ``corner`` it is a part of another picture, there; else it fills its place in a page.
    """
    view = fitted(motion.view)
    height = width * view.height / view.width
    scale = width / view.width
    flip = f"matrix({scale:.6g} 0 0 {-scale:.6g} {-view.left * scale:.6g} {view.high * scale:.6g})"
    world = el(
        "g",
        *(_ground(clip, view) for clip in _distinct(motion.clips)),
        *(_trace(clip) for clip in motion.clips),
        *_frames(motion),
        transform=flip,
    )
    picture = el(
        "svg",
        world,
        class_="motion",
        viewBox=f"0 0 {width:.6g} {height:.6g}",
        role="img",
        aria_label=_SPOKEN,
        **_box(corner, width, height),
    )
    return picture, height


def _box(corner: tuple[float, float] | None, width: float, height: float) -> dict[str, float]:
    if corner is None:
        return {}
    return {"x": corner[0], "y": corner[1], "width": width, "height": round(height)}


def fitted(view: Box) -> Box:
    """The view, made neither too flat nor too tall for a page."""
    width = max(view.width, view.height / _TALLEST)
    height = max(view.height, _LEAST * width)
    middle, foot = (view.left + view.right) / 2, (view.low + view.high) / 2
    return Box(middle - width / 2, foot - height / 2, middle + width / 2, foot + height / 2)


def words(motion: Motion) -> str:
    """What the picture shows."""
    start, end = (scientific(time, 4) for time in motion.span)
    text = f"{FRAMES} frames from {start} to {end} s, the last one strong; lines: centres of mass"
    return f"{text}; arrows: contact forces" if any(one.forces for one in motion.clips) else text


def spring(start: Floats, end: Floats, breadth: float) -> str:
    """A zigzag between two points."""
    along = end - start
    length = float(np.hypot(*along))
    across = np.array([-along[1], along[0]]) / length * breadth if length > 0 else np.zeros(2)
    shares = np.concatenate([[0.0], np.linspace(0.15, 0.85, _SPRING), [1.0]])
    sides = np.concatenate([[0.0, 0.0], np.resize([1.0, -1.0], _SPRING - 2), [0.0, 0.0]])
    corners = start + shares[:, None] * along + sides[:, None] * across
    return "M" + "L".join(f"{x:.5g} {y:.5g}" for x, y in corners)


def _frames(motion: Motion) -> Iterator[Markup]:
    """The frames, and over them the forces, of which the old ones are pale too."""
    arrows: list[Markup] = []
    for index, time in enumerate(_times(motion)):
        clip = next((one for one in motion.clips if time <= one.time[-1]), motion.clips[-1])
        at = int(np.argmin(np.abs(clip.time - time)))
        last = index == FRAMES - 1
        shade = 1.0 if last else 0.2 + 0.4 * index / (FRAMES - 1)
        yield el("g", *_frame(clip, at, motion, last), class_="shot", opacity=f"{shade:.2f}")
        drawn = [arrow for rows in clip.forces.values() for arrow in _arrow(rows[at], motion)]
        arrows.append(el("g", *drawn, class_="pushes", opacity=f"{0.5 + shade / 2:.2f}"))
    yield join(*arrows)


def _times(motion: Motion) -> Floats:
    """Evenly over the motion, but no kick is missed.

    Of a contact whose force is seen in none of the frames the nearest of those between the first
    and the last goes to where that force is largest.
    """
    times = np.linspace(*motion.span, FRAMES)
    free = list(range(1, FRAMES - 1))
    for clip in motion.clips:
        for rows in clip.forces.values():
            sizes = np.nan_to_num(np.hypot(*rows[:, 2:].T)) * motion.newton
            inside = times[(times >= clip.time[0]) & (times <= clip.time[-1])]
            seen = np.interp(inside, clip.time, sizes)
            peak = float(clip.time[np.argmax(sizes)])
            if (
                free
                and sizes.max() > _SEEN * motion.size
                and not np.any(seen > _SEEN * motion.size)
            ):
                moved = min(free, key=lambda index: abs(times[index] - peak))
                times[moved] = peak
                free.remove(moved)
    return np.sort(times)


def _frame(clip: Clip, at: int, motion: Motion, last: bool) -> Iterator[Markup]:
    for piece in clip.pieces:
        if not last and piece.kind != "body":
            continue
        x, y, angle = clip.poses[piece.body][at]
        turn = f"translate({x:.5g} {y:.5g}) rotate({np.degrees(angle):.5g})"
        kind = f"{piece.kind} {piece.style}".strip()
        yield el("path", class_=kind, d=piece.path, transform=turn)
    for colour, rows in clip.sticks:
        x1, y1, x2, y2 = rows[at]
        line = f"M{x1:.5g} {y1:.5g}L{x2:.5g} {y2:.5g}"
        yield el("path", class_=f"stick {colour}", d=line)
    for ends in clip.springs:
        start, end = (clip.place(body, place)[at] for body, place in ends)
        yield el("path", class_="spring", d=spring(start, end, 0.06 * motion.size))


def _arrow(row: Floats, motion: Motion) -> Iterator[Markup]:
    x, y, fx, fy = row
    size = float(np.hypot(fx, fy)) * motion.newton
    if not np.isfinite(size) or size < _SEEN * motion.size:
        return
    tip = np.array([x + fx * motion.newton, y + fy * motion.newton])
    along = np.array([fx, fy]) / np.hypot(fx, fy) * min(0.1 * motion.size, 0.5 * size)
    across = np.array([-along[1], along[0]]) * 0.4
    left, right = tip - along + across, tip - along - across
    line = f"M{x:.5g} {y:.5g}L{tip[0]:.5g} {tip[1]:.5g}"
    head = "".join(f"M{p[0]:.5g} {p[1]:.5g}L{tip[0]:.5g} {tip[1]:.5g}" for p in (left, right))
    yield el("path", class_="force", d=line + head)


def _distinct(clips: list[Clip]) -> list[Clip]:
    """One clip for each ground: phases mostly stand on the same."""
    kept: list[Clip] = []
    for clip in clips:
        if not any(_same_ground(clip, other) for other in kept):
            kept.append(clip)
    return kept


def _same_ground(a: Clip, b: Clip) -> bool:
    names = a.scene["surfaces"].keys()
    return bool(names == b.scene["surfaces"].keys())


def _ground(clip: Clip, view: Box) -> Markup:
    """Each surface with what is below it, as far as the view goes."""
    return join(*(_surface(line, view) for line in clip.surfaces))


def _surface(line: Floats, view: Box) -> Markup:
    left, right = min(view.left, line[0, 0]), max(view.right, line[-1, 0])
    ends = np.array([[left, line[0, 1]], *line, [right, line[-1, 1]]])
    path = "M" + "L".join(f"{x:.5g} {y:.5g}" for x, y in ends)
    below = f"L{right:.5g} {view.low:.5g}L{left:.5g} {view.low:.5g}Z"
    return join(el("path", class_="earth", d=path + below), el("path", class_="surface", d=path))


def _trace(clip: Clip) -> Markup:
    """The way of each centre of mass."""
    ways = [
        (colour, "M" + "L".join(f"{x:.5g} {y:.5g}" for x, y in way)) for colour, way in clip.traces
    ]
    return join(*(el("path", class_=f"trace {colour}", d=path) for colour, path in ways))
