"""003, Figure 6.1: a ball tunnels through a hill where guards are looked at too seldom.

Run: python -m benchmarks.hills. Draws docs/images/hills.svg.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import examples
from footfall.curves import Curves
from footfall.report.markup import Markup, el
from schemas.simulations import read_simulation
from solver.simulation import simulate

Floats = NDArray[np.float64]

PICTURE = Path(__file__).parents[1] / "docs" / "images" / "hills.svg"
WAYS = ((0.01, "#08519c", "max_step 0.01 s, the default"), (0.3, "#d1352b", "max_step 0.3 s"))
SCALE, LEFT, TOP, WIDTH, HEIGHT = 230.0, -0.6, 1.35, 2.9, 1.5
"""Pixels per metre, and the edges of what is shown of the world."""

UNTIL = 1.1
"""Seconds of the motion that are drawn."""


def main() -> None:
    """Simulate twice and draw both ways."""
    x = np.linspace(LEFT, LEFT + WIDTH, 600)
    parts = [_line(x, 0.4 * np.exp(8 * (np.cos(2 * np.pi * x / 0.7) - 1)), "#444", 2)]
    for row, (step, colour, words) in enumerate(WAYS):
        parts.append(_line(*way(step), colour, 1.6))
        place = {"x": "400", "y": f"{20 + 17 * row}", "font_family": "sans-serif"}
        parts.append(el("text", words, fill=colour, font_size="13", **place))
    size = {"width": f"{SCALE * WIDTH:g}", "height": f"{SCALE * HEIGHT:g}"}
    box = f"0 0 {size['width']} {size['height']}"
    white = el("rect", width="100%", height="100%", fill="white")
    picture = el("svg", white, *parts, xmlns="http://www.w3.org/2000/svg", viewBox=box, **size)
    PICTURE.write_text(picture + "\n", encoding="utf-8")
    print(f"drawn: {PICTURE.relative_to(PICTURE.parents[2])}")


def way(step: float) -> tuple[Floats, Floats]:
    """The ball's way, x and y, with guards looked at every ``step``, s."""
    method = {"kind": "events", "max_step": step}
    document = examples.load("ball_on_hills") | {"duration": UNTIL, "method": method}
    result = simulate(read_simulation(document))
    curves = Curves.from_dict(result.phases[0].curves["states"].model_dump())
    found = curves.sample(np.linspace(0.0, UNTIL, 300))
    return found["ball.x"], found["ball.y"]


def _line(x: Floats, y: Floats, colour: str, width: float) -> Markup:
    pixels = zip(SCALE * (x - LEFT), SCALE * (TOP - y), strict=True)
    along = " ".join(f"{a:.1f},{b:.1f}" for a, b in pixels)
    return el("polyline", points=along, fill="none", stroke=colour, stroke_width=f"{width:g}")


if __name__ == "__main__":
    main()
