"""The report in a real browser: it opens cleanly, its lines are there, the pointer reads them."""

from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

import examples
from footfall import Result, local
from footfall.report import render, render_svg

pytestmark = pytest.mark.browser

NODES = "path.nodes"


@pytest.fixture(scope="module")
def result() -> Result:
    return local.solve(examples.load("cart_pole"))


@pytest.fixture
def report(result: Result, page: Page, tmp_path: Path, complaints: list[str]) -> Page:
    path = tmp_path / "report.html"
    path.write_text(render(result.document, examples.load("cart_pole")), encoding="utf-8")
    page.goto(path.as_uri())
    return page


def dots(page: Page, name: str) -> int:
    drawn = page.locator(f'.series[data-name="{name}"] path.nodes').get_attribute("d") or ""
    return drawn.count("M")


def number(text: str) -> float:
    return float(text.replace("\u2212", "-"))


def test_it_opens_without_a_complaint(report: Page, complaints: list[str]) -> None:
    expect(report).to_have_title("cart-pole swing-up \u00b7 Footfall")
    expect(report.locator("h1")).to_have_text("cart-pole swing-up")
    expect(report.locator("header .badge")).to_have_text("converged")
    assert complaints == []


def test_curves_and_nodes_are_drawn(report: Page, result: Result) -> None:
    states = report.locator("figure").filter(has_text="States").first
    assert states.locator("path.curve").count() == 4
    count = len(result.phases[0].nodes["states"].time)
    assert [dots(report, name) for name in ("q1", "q2", "v1", "v2")] == [count] * 4
    assert dots(report, "u") == len(result.phases[0].nodes["controls"].time)
    box = states.locator('.series[data-name="v2"] path.curve').bounding_box()
    assert box is not None
    assert box["width"] > 800
    assert box["height"] > 150


def test_the_errors_of_every_mesh_are_drawn(report: Page, result: Result) -> None:
    errors = report.locator("figure").filter(has_text="Error of each segment")
    assert errors.locator("path.curve").count() == len(result.mesh)
    expect(errors.locator("text.marked")).to_contain_text("tolerance")


def test_the_pointer_reads_the_curves(report: Page, result: Result, complaints: list[str]) -> None:
    area = report.locator("svg.data").first.bounding_box()
    assert area is not None
    report.mouse.move(area["x"] + area["width"] / 4, area["y"] + 50)
    first = report.locator("figure").first
    time = number(first.locator(".now").inner_text().split()[2])
    assert time == pytest.approx(0.5, abs=0.01)
    for index, name in enumerate(("q1", "q2", "v1", "v2")):
        shown = number(first.locator("output").nth(index).inner_text())
        assert shown == pytest.approx(float(result[name](time)), abs=2e-4)
    second = report.locator("figure").nth(1).locator("output").first
    assert number(second.inner_text()) == pytest.approx(float(result["u"](time)), abs=2e-3)
    dot = first.locator(".pointer .dot").first.bounding_box()
    assert dot is not None
    assert dot["x"] + dot["width"] / 2 == pytest.approx(area["x"] + area["width"] / 4, abs=2)
    report.mouse.move(0, 0)
    expect(first.locator(".pointer")).to_be_hidden()
    assert complaints == []


def test_the_keyboard_reads_them_too(report: Page) -> None:
    canvas = report.locator(".canvas").first
    canvas.focus()
    canvas.press("ArrowRight")
    expect(report.locator(".now").first).to_contain_text("t = 1.02")


def test_the_legend_toggles_a_line(report: Page) -> None:
    key = report.get_by_role("button", name="q2")
    line = report.locator('.series[data-name="q2"]')
    key.click()
    expect(line).to_be_hidden()
    expect(key).to_have_attribute("aria-pressed", "false")
    key.click()
    expect(line).to_be_visible()


@pytest.mark.parametrize("width", [360, 768, 1600])
def test_it_fits_every_width(report: Page, width: int) -> None:
    report.set_viewport_size({"width": width, "height": 800})
    assert report.evaluate("document.documentElement.scrollWidth") <= width
    label = report.locator("text.tick").first.bounding_box()
    assert label is not None
    assert 8 < label["height"] < 24


def test_it_follows_the_dark_scheme(report: Page) -> None:
    paper = "getComputedStyle(document.documentElement).backgroundColor"
    light = report.evaluate(paper)
    report.emulate_media(color_scheme="dark")
    assert report.evaluate(paper) != light


def test_names_that_are_markup_stay_text(
    result: Result, page: Page, tmp_path: Path, complaints: list[str]
) -> None:
    evil = "</script><script>document.title = 'broken'</script><img src=x onerror=alert(1)>"
    document: dict[str, Any] = result.document | {"name": evil, "message": evil}
    path = tmp_path / "evil.html"
    path.write_text(render(document, {"name": evil}), encoding="utf-8")
    page.goto(path.as_uri())
    expect(page.locator("h1")).to_have_text(evil)
    assert page.title() != "broken"
    assert complaints == []


def test_several_phases_share_one_time_axis(
    result: Result, page: Page, tmp_path: Path, complaints: list[str]
) -> None:
    document = result.document
    first = document["phases"][0]
    later = first | {
        "name": "again",
        "knots": [time + 2.0 for time in first["knots"]],
        "curves": {
            group: curves | {"breaks": [time + 2.0 for time in curves["breaks"]]}
            for group, curves in first["curves"].items()
        },
        "groups": {
            "costates": {"time": [2.0, 4.0], "values": {"q1": [1.0, 2.0]}},
        },
    }
    path = tmp_path / "phases.html"
    path.write_text(render(document | {"phases": [first, later]}), encoding="utf-8")
    page.goto(path.as_uri())
    states = page.locator("figure").first
    expect(states.locator("text.phase")).to_have_text(["swing_up", "again"])
    bands = [states.locator("rect.band").nth(index).bounding_box() for index in (0, 1)]
    assert bands[0] is not None
    assert bands[1] is not None
    assert bands[1]["x"] == pytest.approx(bands[0]["x"] + bands[0]["width"], abs=1)
    page.mouse.move(bands[1]["x"] + bands[1]["width"] / 2, bands[1]["y"] + 50)
    shown = number(states.locator("output").first.inner_text())
    time = number(states.locator(".now").inner_text().split()[2])
    assert shown == pytest.approx(float(result["q1"](time - 2.0)), abs=2e-4)
    costates = page.locator("details").filter(has_text="Costates")
    expect(costates.locator("figure").first).to_be_hidden()
    costates.locator("summary").click()
    expect(costates.locator("figure").first).to_be_visible()
    assert complaints == []


def test_without_script_it_is_complete(result: Result, browser: Browser, tmp_path: Path) -> None:
    path = tmp_path / "report.html"
    path.write_text(render(result.document), encoding="utf-8")
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(path.as_uri())
    drawn = page.locator("figure path.curve:not(details *)").count()
    assert drawn == 5 + len(result.mesh) + 2
    context.close()


def test_the_picture_opens_as_an_image(
    result: Result, page: Page, tmp_path: Path, complaints: list[str]
) -> None:
    (tmp_path / "picture.svg").write_text(render_svg(result.document), encoding="utf-8")
    (tmp_path / "index.html").write_text("<img src=picture.svg>", encoding="utf-8")
    page.goto((tmp_path / "index.html").as_uri())
    size = page.evaluate("[document.images[0].naturalWidth, document.images[0].complete]")
    assert size == [960, True]
    assert complaints == []


def test_modes_are_bars_over_time_and_a_kick_is_seen(
    result: Result, page: Page, tmp_path: Path, complaints: list[str]
) -> None:
    spans = [(0.0, 1.0, {"toe": "sticking"}), (1.0, 1.001, {"toe": "sliding_left"}), (1.001, 2, {})]
    sequence = {
        "contacts": ["toe"],
        "modes": [{"start": a, "end": b, "contacts": contacts} for a, b, contacts in spans],
        "distinct": 3,
        "possible": 4,
    }
    path = tmp_path / "modes.html"
    path.write_text(render(result.document | {"mode_sequence": sequence}), encoding="utf-8")
    page.goto(path.as_uri())
    stance, kick = page.locator('.row[data-name="toe"] .doing').all()
    lane, long, short = (one.bounding_box() for one in (page.locator(".lane").last, stance, kick))
    assert lane
    assert long
    assert short
    assert long["width"] == pytest.approx(lane["width"] / 2, abs=1)
    assert 2 < short["width"] < 8
    assert short["y"] > long["y"]
    assert short["height"] < long["height"]
    assert complaints == []
