"""A figure in the page: caption, legend that toggles and reads out, the plot, notes."""

from footfall.report.drawing import frame
from footfall.report.figures import Figure, Series
from footfall.report.markup import Markup, el, join

_HEIGHTS = {"tall": 320, "low": 230}


def plot(figure: Figure, number: int | None, size: str = "tall") -> Markup:
    """A figure with its legend. ``number`` finds its data for the pointer; None: no pointer."""
    dashed = any(item.limits for item in figure.series)
    dots = number is not None and any(item.nodes for item in figure.series)
    notes = [*["dots: nodes"] * dots, *["dashed: bounds"] * dashed, *figure.notes]
    drawn = frame(
        figure, class_="frame", height=_HEIGHTS[size], role="img", aria_label=_spoken(figure)
    )
    focus = {} if number is None else {"tabindex": 0, "data_figure": number}
    return el(
        "figure",
        el(
            "figcaption",
            el("span", figure.title, class_="title"),
            el("span", "", class_="now") if number is not None else None,
            el("span", "; ".join(notes), class_="notes") if notes else None,
        ),
        el("div", *map(_key, figure.series), class_="legend") if number is not None else None,
        el("div", drawn, class_="canvas", **focus),
    )


def _key(item: Series) -> Markup:
    swatch = el(
        "svg",
        el("line", class_="curve", x1=0, x2=18, y1=5, y2=5),
        class_=f"swatch series {item.style}",
        width=18,
        height=10,
        aria_hidden="true",
    )
    name = join(swatch, el("span", item.label), el("output", ""))
    return el("button", name, class_="key", type="button", aria_pressed="true")


def _spoken(figure: Figure) -> str:
    names = ", ".join(item.label for item in figure.series)
    return f"{figure.title} over time: {names}"
