"""A result as one self-contained page, or as one picture.

Everything is drawn here, as SVG, from the result's Chebyshev coefficients; the page's small
script only reads values under the pointer and toggles lines. Nothing is loaded from anywhere.
"""

from footfall.report.page import render
from footfall.report.picture import render_svg

__all__ = ["render", "render_svg"]
