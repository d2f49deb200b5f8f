"""A result as one self-contained page, or as pictures.

Everything is drawn here, as SVG, from the result's Chebyshev coefficients; the page's small
scripts only read values under the pointer, toggle lines and play the motion. Nothing is loaded
from anywhere.
"""

from footfall.report.page import render
from footfall.report.picture import render_motion, render_svg

__all__ = ["render", "render_motion", "render_svg"]
