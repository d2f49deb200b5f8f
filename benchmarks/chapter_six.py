"""The maps of 003, Figures 6.8 to 6.10: a stick that topples from rest.

Run: python -m benchmarks.chapter_six. Draws docs/images/toppling_*.svg and prints what the text
says of them.
"""

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

import examples
from benchmarks.heat import Axis, Heat, page, ramp
from schemas.simulations import read_simulation
from solver.simulation import simulate

IMAGES = Path(__file__).parents[1] / "docs" / "images"

FRICTION = np.geomspace(0.05, 10.0, 28)
INERTIA = np.geomspace(0.01, 1.0, 24)

LEAST = 1e-4
"""Slips below it are none: with finite friction everything creeps a little at the end."""

BACK, NONE, FORTH = -1.0, 0.0, 1.0


class Fall(NamedTuple):
    """How far the foot slips, over L: against and along the fall; where it first does, degrees.

    ``first`` is the direction of the first slip that is more than none.
    """

    backward: float
    forward: float
    critical: float
    first: float


def main() -> None:
    """Topple every stick, draw, and print."""
    falls = [[topple(mu, inertia) for mu in FRICTION] for inertia in INERTIA]
    for name, maps in _maps(falls).items():
        path = IMAGES / f"toppling_{name}.svg"
        path.write_text(page(maps) + "\n", encoding="utf-8")
        print(f"drawn: {path.relative_to(IMAGES.parents[1])}")
    slender = [topple(mu, 1 / 3) for mu in (0.2, 0.5, 1.0, 5.0)]
    for mu, fall in zip((0.2, 0.5, 1.0, 5.0), slender, strict=True):
        print(f"slender rod, friction {mu:g}: {fall}")


def topple(friction: float, inertia: float) -> Fall:
    """One stick, M = g = L = 1, from 0.05 rad with the energy of the upright one."""
    document = examples.load("toppling_stick")
    document["system"]["parameters"] |= {"I": inertia, "mu": friction}
    result = simulate(read_simulation(document | {"duration": 40, "samples": 2}))
    states = result.phases[0].groups["states"]
    angle = np.array(states.values["stick.angle"], dtype=float)
    foot = np.array(states.values["stick.x"], dtype=float) + np.sin(angle)
    moves = np.diff(foot)
    slips = [event.time for event in result.events if event.kind == "slip"]
    critical = math.nan
    if slips:
        critical = math.degrees(angle[states.time.index(slips[0])])
    # The stick falls to the left: backward is to the right.
    large = moves[np.abs(moves) > LEAST]
    first = NONE if not len(large) else (BACK if large[0] > 0 else FORTH)
    return Fall(float(moves[moves > 0].sum()), float(-moves[moves < 0].sum()), critical, first)


def _maps(falls: list[list[Fall]]) -> dict[str, list[Heat]]:
    table = np.array(falls)
    x = Axis("coefficient of friction", FRICTION, (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10))
    y = Axis("moment of inertia I / (M L²)", INERTIA, (0.01, 0.03, 0.1, 1 / 3, 1))
    y = Axis(y.title, INERTIA, (0.01, 0.03, 0.1, 0.3, 1))
    blue, red = ["#ffffff", "#9ecae1", "#08519c"], ["#ffffff", "#fcae91", "#a50f15"]
    angles = ["#fff7bc", "#fec44f", "#d95f0e", "#7f2704"]
    backward, forward = ramp(blue, 0, 1.0), ramp(red, 0, 0.15)
    direction = {BACK: "#08519c", NONE: "#ffffff", FORTH: "#a50f15"}
    words = [(BACK, "backward"), (FORTH, "forward"), (NONE, "none")]
    tens = [(float(v), f"{v}°") for v in (10, 30, 50, 70, 90)]
    return {
        "slip": [
            Heat("slip backward, over L", x, y, table[..., 0], backward, _legend(0.0, 1.0)),
            Heat("slip forward, over L", x, y, table[..., 1], forward, _legend(0.0, 0.15)),
        ],
        "angle": [Heat("angle at the first slip", x, y, table[..., 2], ramp(angles, 0, 90), tens)],
        "first": [
            Heat("first slip", x, y, table[..., 3], lambda one: direction[one], words),
        ],
    }


def _legend(low: float, high: float) -> list[tuple[float, str]]:
    return [(float(value), f"{value:.3g}") for value in np.linspace(low, high, 6)]


if __name__ == "__main__":
    main()
