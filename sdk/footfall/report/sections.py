"""Sections that the pages of solves and of simulations share."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

from footfall.report.animation import player
from footfall.report.figures import TOGETHER, Figure, trajectories
from footfall.report.markup import Child, Markup, el, join
from footfall.report.modes import keys, said, sequences_of, timeline
from footfall.report.motion import Motion
from footfall.report.phases import COSTATES, IMPULSES
from footfall.report.plots import plot
from footfall.report.scales import scientific
from footfall.report.strobe import strobe, words
from footfall.report.tables import grid, pairs
from footfall.summary import mode_words, plural

_STILL = 976.0
"""The width of the still picture in px; it is stretched with the page."""


_FOLDED = {COSTATES: "Costates", IMPULSES: "Impulses"}
"""Groups that few readers want."""

_MODES = 200
"""Rows of the table of modes; an accumulation of impacts has thousands."""


def remarks(result: Mapping[str, Any]) -> Markup | None:
    """Warnings and advice."""
    found = [
        *(el("li", text, class_="warning") for text in result.get("warnings", [])),
        *(el("li", text, class_="advice") for text in result.get("advice", [])),
    ]
    return el("ul", *found, class_="remarks") if found else None


def trajectory(
    result: Mapping[str, Any], problem: Mapping[str, Any] | None, figures: list[Figure]
) -> Markup | None:
    """All phases over one time axis; costates and impulses folded away."""
    all_phases = result["phases"]
    if not all_phases:
        return None
    found = list(trajectories(all_phases, problem))
    plots = {
        id(figure): numbered(figure, figures, "low" if index else "tall")
        for index, figure in enumerate(found)
    }
    folded = {
        title: [plots[id(figure)] for figure in found if figure.group == group]
        for group, title in _FOLDED.items()
    }
    return section(
        "Trajectory",
        _phases(all_phases)
        if len(all_phases) > 1
        else el("p", _span(all_phases[0]), class_="lead"),
        *(plots[id(figure)] for figure in found if figure.group not in _FOLDED),
        *(el("details", el("summary", title), *them) for title, them in folded.items() if them),
        *map(_integrals, all_phases),
        join(el("h3", "Static parameters"), _values(result["static"]))
        if result.get("static")
        else None,
    )


def modes(result: Mapping[str, Any]) -> Markup | None:
    """Which contacts touched when, and how: the picture, and the table folded away."""
    given = sequences_of(result)
    if given is None:
        return None
    legend = [
        el("span", el("svg", swatch, width=22, height=12, aria_hidden="true"), name, class_="key")
        for name, swatch in keys(given)
    ]
    drawn, _ = timeline(given, class_="frame")
    figure = el(
        "figure",
        el("div", *legend, class_="legend"),
        el("div", drawn, class_="canvas"),
        class_="modes",
    )
    found = result["mode_sequence"]["modes"]
    rows: list[list[Child]] = [
        [number, scientific(mode["start"], 6), scientific(mode["end"], 6), mode_words(mode)]
        for mode, number in list(zip(found, given.found.numbers, strict=True))[:_MODES]
    ]
    left = len(found) - _MODES
    more = el("p", f"and {plural(left, 'more mode')}", class_="lead") if left > 0 else None
    table = grid(["mode", "from [s]", "to [s]", "contacts"], rows, numeric={0, 1, 2})
    folded = el("details", el("summary", plural(len(found), "mode")), table, more)
    return section("Modes", el("p", said(given), class_="lead"), figure, folded)


def _span(phase: Mapping[str, Any]) -> str:
    start, end = phase["knots"][0], phase["knots"][-1]
    size = plural(len(phase["knots"]) - 1, "segment")
    return f"{phase['name']}: {scientific(start, 6)} to {scientific(end, 6)} s, {size}"


def _phases(all_phases: Sequence[Mapping[str, Any]]) -> Markup:
    """One line for each phase, in its colour."""
    lines = [
        el("li", el("span", "", class_=f"chip s{index % TOGETHER}"), _span(phase))
        for index, phase in enumerate(all_phases)
    ]
    return el("ol", *lines, class_="phases")


def _integrals(phase: Mapping[str, Any]) -> Markup | None:
    sums = phase.get("integrals", {})
    return join(el("h3", f"Integrals of {phase['name']}"), _values(sums)) if sums else None


def _values(numbers: Mapping[str, float | None]) -> Markup:
    return pairs({name: scientific(value, 10) for name, value in numbers.items()})


def again(
    result: Mapping[str, Any], document: Mapping[str, Any] | None, command: str = "solve"
) -> Markup:
    """What is needed to compute it again, the document folded away."""
    record = result["reproduce"]
    facts = {"spec sha256": el("code", record["spec_sha256"])}
    facts |= {name: el("span", version) for name, version in record["versions"].items()}
    if record["seed"] is not None:
        facts["seed"] = el("span", record["seed"])
    noun = "problem" if command == "solve" else "simulation"
    how = el(
        "p",
        f"Save the {noun} below as {noun}.json, then: ",
        el("code", f"footfall {command} {noun}.json"),
    )
    text = json.dumps(document, indent=2, ensure_ascii=False) if document is not None else ""
    folded = el("details", el("summary", f"The {noun}"), el("pre", text)) if text else None
    return section("Reproduce", how if text else None, pairs(facts), folded)


def numbered(figure: Figure, figures: list[Figure], size: str) -> Markup:
    """A figure whose data the page's script finds by its number."""
    figures.append(figure)
    return plot(figure, len(figures) - 1, size)


def section(title: str, *children: Markup | None) -> Markup:
    """A part of the page under a heading."""
    return el("section", el("h2", title), *children)


def moving(motion: Motion | None) -> Markup | None:
    """The animation, and several frames over one another."""
    if motion is None:
        return None
    caption = el(
        "figcaption",
        el("span", "The motion", class_="title"),
        el("span", words(motion), class_="notes"),
    )
    still = el("figure", caption, strobe(motion, _STILL)[0], class_="still")
    return section("Motion", player(motion), still)
