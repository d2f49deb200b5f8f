"""The animation in the page: a canvas with its controls, and the data that its script reads."""

from typing import Any

import numpy as np

from footfall.curves import Floats
from footfall.report.markup import Markup, el, void
from footfall.report.motion import Clip, Motion
from footfall.report.strobe import fitted

_SEEN = 1.5  # s on the screen, at least, unless the motion is very short
_SPEEDS = ("0.1", "0.25", "0.5", "1", "2", "4")


def player(motion: Motion) -> Markup:
    """The canvas with its controls; hidden until the script shows it."""
    view = fitted(motion.view)
    shape = "3 / 2" if motion.follow else f"{view.width:.5g} / {view.height:.5g}"
    start, end = motion.span
    usual = _usual(end - start)
    speeds = [
        el(
            "option",
            f"\N{MULTIPLICATION SIGN} {speed}",
            value=speed,
            selected="" if speed == usual else None,
        )
        for speed in _SPEEDS
    ]
    controls = el(
        "div",
        el("button", "Play", type="button", class_="play", aria_pressed="false"),
        void(
            "input",
            type="range",
            class_="scrub",
            min=start,
            max=end,
            step="any",
            value=start,
            aria_label="time",
        ),
        el("output", "", class_="clock"),
        el("label", "speed ", el("select", *speeds, class_="speed")),
        el("label", void("input", type="checkbox", class_="loop", checked=""), " loop"),
        class_="controls",
    )
    stage = el(
        "canvas", class_="stage", role="img", aria_label="The motion, animated", data_shape=shape
    )
    caption = el(
        "figcaption",
        el("span", "Animation", class_="title"),
        el("span", "", class_="phase-name"),
        el("span", _legend(motion), class_="notes"),
    )
    return el("figure", caption, stage, controls, class_="player", hidden="")


def motion_data(motion: Motion) -> dict[str, Any]:
    """What the script needs; lengths in m, times in s."""
    view = fitted(motion.view)
    return {
        "view": _rounded(np.array([view.left, view.low, view.right, view.high])),
        "follow": motion.follow,
        "size": motion.size,
        "newton": motion.newton,
        "clips": [_clip(clip) for clip in motion.clips],
    }


def _clip(clip: Clip) -> dict[str, Any]:
    return {
        "name": clip.name,
        "time": _rounded(clip.time),
        "poses": {name: _rounded(rows) for name, rows in clip.poses.items() if name != "ground"},
        "pieces": [[piece.body, piece.kind, piece.style, piece.path] for piece in clip.pieces],
        "springs": [
            [[body, _rounded(at)] for body, at in (start, end)] for start, end in clip.springs
        ],
        "surfaces": [_rounded(line) for line in clip.surfaces],
        "forces": [_rounded(rows) for rows in clip.forces.values()],
        "traces": [[colour, _rounded(rows)] for colour, rows in clip.traces],
        "sticks": [[colour, _rounded(rows)] for colour, rows in clip.sticks],
    }


def _rounded(values: Floats) -> Any:
    if values.ndim > 1:
        return [_rounded(row) for row in values]
    return [float(f"{value:.6g}") if np.isfinite(value) else None for value in values]


def _usual(seconds: float) -> str:
    """At most real time, and so slow that the motion can be seen."""
    slow = [speed for speed in _SPEEDS if float(speed) <= min(1.0, seconds / _SEEN)]
    return slow[-1] if slow else _SPEEDS[0]


def _legend(motion: Motion) -> str:
    parts = ["lines: ways of the centres of mass"]
    if any(clip.forces for clip in motion.clips):
        parts.append("arrows: contact forces" + (", the longest cut" if motion.cut else ""))
    return "; ".join(parts)
