"""Mode sequences as users meet them: in the SDK, on a terminal, in the page and in the picture."""

import xml.etree.ElementTree as ET
from typing import Any

import pytest

from footfall import ModeSequence, Result, render, render_svg
from footfall.summary import in_words, summarize

SVG = "{http://www.w3.org/2000/svg}"

MODES: list[tuple[float, float, dict[str, str]]] = [
    (0.0, 0.5, {"toe": "sticking"}),
    (0.5, 0.501, {"toe": "sticking", "heel": "sliding_right"}),
    (0.501, 1.0, {"toe": "sliding_left"}),
    (1.0, 1.6, {"limit.knee": "upper"}),
    (1.6, 2.0, {"toe": "sticking"}),
]
"""One step of it is a kick of a millisecond."""

NAMES = ["toe", "heel", "limit.knee"]


def sequence(modes: list[tuple[float, float, dict[str, str]]]) -> dict[str, Any]:
    different = {frozenset(contacts.items()) for _, _, contacts in modes}
    return {
        "contacts": NAMES,
        "modes": [{"start": a, "end": b, "contacts": contacts} for a, b, contacts in modes],
        "distinct": len(different),
        "possible": 4 * 4 * 3,
    }


@pytest.fixture
def stepped(solved: dict[str, Any]) -> dict[str, Any]:
    """The cart-pole as if it had feet."""
    guess = sequence([(0.0, 1.0, {"toe": "sticking", "heel": "sticking"}), (1.0, 2.0, {})])
    return solved | {"mode_sequence": sequence(MODES), "guessed_sequence": guess}


def test_the_result_has_its_modes_and_their_changes(stepped: dict[str, Any]) -> None:
    result = Result(stepped)
    found, guessed = result.mode_sequence, result.guessed_sequence
    assert isinstance(found, ModeSequence)
    assert guessed is not None
    assert [(one.time, one.name, one.before, one.after) for one in found.transitions] == [
        (0.5, "heel", "free", "sliding_right"),
        (0.501, "toe", "sticking", "sliding_left"),
        (0.501, "heel", "sliding_right", "free"),
        (1.0, "toe", "sliding_left", "free"),
        (1.0, "limit.knee", "free", "upper"),
        (1.6, "toe", "free", "sticking"),
        (1.6, "limit.knee", "upper", "free"),
    ]
    assert found.numbers == [1, 2, 3, 4, 1]
    assert found.spans("toe") == [
        (0.0, 0.501, "sticking"),
        (0.501, 1.0, "sliding_left"),
        (1.0, 1.6, "free"),
        (1.6, 2.0, "sticking"),
    ]
    assert found.at(0.5) == {"toe": "sticking", "heel": "sliding_right"}
    assert found.at(2.5) == {}
    assert guessed.distinct == 2


def test_results_without_modes_have_none(solved: dict[str, Any]) -> None:
    assert Result(solved).mode_sequence is None
    assert Result(solved).guessed_sequence is None
    assert "Modes" not in render(solved)
    assert "modes" not in in_words(solved)


def test_a_terminal_shows_who_touches_and_the_shortest_kick(stepped: dict[str, Any]) -> None:
    assert "  modes        5 modes, 4 distinct of 48 possible" in summarize(stepped).splitlines()
    lines = ModeSequence.of(stepped["mode_sequence"]).timeline(20).splitlines()
    assert lines[0] == "toe         #####<<<<<......####"
    assert lines[1] == "heel        .....>.............."
    assert lines[2] == "limit.knee  ..........^^^^^^...."
    assert lines[3].split() == ["0", "s", "2", "s"]
    assert "> sliding right" in lines[4]
    assert "^ upper" in lines[4]
    text = in_words(stepped)
    assert text.index("of the guess") < text.index("of the result")
    assert "toe sticking, heel sliding right" in text


def rects(drawn: ET.Element, name: str) -> list[ET.Element]:
    """All that is drawn of one contact."""
    row = next(one for one in drawn.iter(f"{SVG}g") if one.get("data-name") == name)
    return list(row.iter(f"{SVG}rect"))


def bars(drawn: ET.Element, name: str) -> list[tuple[str, float, float]]:
    """Class, left edge and width, in percent, of what one contact does."""
    return [
        (one.attrib["class"], percent(one.attrib["x"]), percent(one.attrib["width"]))
        for one in rects(drawn, name)
        if one.attrib["class"] != "lane"
    ]


def percent(text: str) -> float:
    return float(text.rstrip("%"))


def place(drawn: ET.Element, name: str, word: str) -> tuple[float, float]:
    """Where in its lane a bar begins, and its height, px."""
    found = rects(drawn, name)
    lane = [one for one in found if one.attrib["class"] == "lane"][-1]
    bar = next(one for one in found if one.attrib["class"] == f"doing {word}")
    return float(bar.attrib["y"]) - float(lane.attrib["y"]), float(bar.attrib["height"])


def test_the_picture_has_a_bar_for_all_that_touches(stepped: dict[str, Any]) -> None:
    drawn = ET.fromstring(render_svg(stepped))  # noqa: S314 - our own text
    guess, *found = bars(drawn, "toe")
    assert guess == ("doing stick", 0.0, 50.0)
    assert found == [
        ("doing stick", 0.0, 25.05),
        ("doing left", 25.05, 24.95),
        ("doing stick", 80.0, 20.0),
    ]
    assert bars(drawn, "limit.knee") == [("doing stop", 50.0, 30.0)]
    kick = bars(drawn, "heel")[-1]
    assert kick[0] == "doing right"
    assert kick[2] > 6 * 0.05  # percent: seen, though it lasts for a twentieth of one


def test_left_and_right_differ_by_more_than_colour(stepped: dict[str, Any]) -> None:
    drawn = ET.fromstring(render_svg(stepped))  # noqa: S314 - our own text
    assert place(drawn, "heel", "right") == (0.0, 8.0)
    assert place(drawn, "toe", "left") == (8.0, 8.0)


def test_the_page_tells_modes_and_changes(stepped: dict[str, Any]) -> None:
    page = render(stepped)
    assert "4 distinct modes of 48 possible ones, 7 changes of contacts" in page
    assert page.count('class="kind ') == len(MODES)
    assert "at upper limit" in page
    assert "thin bars above are the guess" in page


def test_names_are_escaped(stepped: dict[str, Any]) -> None:
    evil = "</svg><script>alert(1)</script>"
    modes = sequence([(0.0, 1.0, {evil: evil})]) | {"contacts": [evil]}
    assert "<script>alert" not in render(stepped | {"mode_sequence": modes})
    ET.fromstring(render_svg(stepped | {"mode_sequence": modes}))  # noqa: S314 - our own text


def passes(*products: float) -> list[dict[str, Any]]:
    rest = {"form": "equality", "status": "optimal", "nlp_iterations": 9, "seconds": 0.1}
    return [
        rest | {"relaxation": 10.0**-k, "objective": 5.0 - k, "residual": product}
        for k, product in enumerate(products)
    ]


def test_the_page_tells_how_contacts_became_strict(solved: dict[str, Any]) -> None:
    told = {
        "form": "fischer_burmeister",
        "passes": passes(1.0, 0.1, 0.01),
        "polished": True,
        "residual": 3e-10,
        "stationarity": "strong",
        "pinned": 2,
        "dissipation": 0.084,
    }
    page = render(solved | {"complementarity": told})
    assert "fischer burmeister" in page
    assert "8.4 % of the actuators" in page
    assert page.count('data-name="largest product of a pair"') == 1
    alone = render(solved | {"complementarity": told | {"passes": passes(1.0)}})
    assert "largest product of a pair" not in alone
    assert "Complementarity" not in render(solved)


def test_impulses_are_steps_and_folded_away(solved: dict[str, Any]) -> None:
    phase = solved["phases"][0]
    knots = phase["knots"]
    values = [float(k % 2) for k in range(len(knots) - 1)]
    impulses = {"time": knots[1:], "values": {"contact.toe.normal": values}}
    groups = phase["groups"] | {"impulses": impulses}
    result = solved | {"phases": [phase | {"groups": groups}]}
    page = render(result)
    line = page.split('data-name="impulse of contact.toe.normal"')[1].split('d="')[1].split('"')[0]
    heights = {point.split(" ")[1] for point in line.replace("M", "L").split("L") if point}
    assert len(heights) == 2
    assert "impulse of contact.toe.normal" not in render_svg(result)
