"""The animation in a real browser: it plays, it is led and leads, and it draws where bodies are."""

from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from footfall.report import render, render_motion
from tests.support.motions import END, rolling, throw

pytestmark = pytest.mark.browser

RESULT = throw(rolling())
WRAPS = """
() => new Promise((done) => {
  let last = 0;
  followers.push((t) => { if (t < last) done(); last = t; });
})
"""
INK = """
([x, y]) => {
  const canvas = document.querySelector('.stage'), [left, low, right] = player.stage.seen;
  const scale = canvas.width / (right - left), foot = canvas.height;
  const at = [(x - left) * scale, foot - (y - low) * scale];
  return [...canvas.getContext('2d').getImageData(...at.map(Math.round), 1, 1).data];
}
"""


@pytest.fixture
def report(page: Page, tmp_path: Path) -> Page:
    path = tmp_path / "report.html"
    path.write_text(render(RESULT), encoding="utf-8")
    page.goto(path.as_uri())
    return page


def scrub(page: Page, time: float) -> None:
    script = "(e, t) => { e.value = String(t); e.dispatchEvent(new Event('input')); }"
    page.locator(".scrub").evaluate(script, time)


def shown(page: Page) -> float:
    return float(page.evaluate("player.stage.t"))


def ink(page: Page, x: float, y: float) -> list[int]:
    """The colour at a place of the world: red, green, blue, and 0 where nothing was drawn."""
    found: list[int] = page.evaluate(INK, [x, y])
    return found


def test_it_is_drawn_without_a_complaint(report: Page, complaints: list[str]) -> None:
    expect(report.locator(".player")).to_be_visible()
    expect(report.locator(".still svg")).to_be_visible()
    expect(report.locator(".clock")).to_have_text("0.000 s")
    assert complaints == []


def test_the_bodies_are_where_the_frames_put_them(report: Page) -> None:
    scrub(report, END / 2)
    assert shown(report) == pytest.approx(END / 2)
    middle, beside = ink(report, 0.4, 0.08), ink(report, 0.4, 0.2)
    assert middle[3] == 255
    assert beside[3] == 0
    below = ink(report, 0.5, -0.35)  # the rod hangs after half a turn
    assert below[3] == 255
    scrub(report, 0)
    assert ink(report, 0.1, 0.08)[3] == 255
    assert ink(report, 0.4, 0.08)[3] == 0


def test_it_plays_to_the_end_and_stops(report: Page, complaints: list[str]) -> None:
    report.locator(".loop").uncheck()
    report.locator(".speed").select_option("4")
    report.get_by_role("button", name="Play").click()
    expect(report.locator(".play")).to_have_text("Pause")
    expect(report.locator(".play")).to_have_text("Play", timeout=20_000)
    assert shown(report) == pytest.approx(END)
    expect(report.locator(".clock")).to_have_text("1.500 s")
    assert complaints == []


def test_a_loop_goes_on_until_it_is_paused(report: Page) -> None:
    report.locator(".speed").select_option("4")
    report.get_by_role("button", name="Play").click()
    report.evaluate(WRAPS)
    report.get_by_role("button", name="Pause").click()
    stopped = shown(report)
    report.wait_for_timeout(100)
    assert shown(report) == stopped


def test_the_plots_show_the_time_of_the_motion(report: Page) -> None:
    scrub(report, 0.75)
    expect(report.locator("figure .now").first).to_have_text("t = 0.75000 s")


def test_the_pointer_on_a_plot_leads_the_motion(report: Page) -> None:
    area = report.locator("svg.data").first
    area.scroll_into_view_if_needed()
    box = area.bounding_box()
    assert box is not None
    report.mouse.move(box["x"] + box["width"] / 3, box["y"] + 20)
    assert shown(report) == pytest.approx(END / 3, abs=0.01)
    expect(report.locator(".clock")).to_contain_text("0.49")


@pytest.mark.parametrize("width", [360, 1200])
def test_it_fits_every_width(report: Page, width: int) -> None:
    report.set_viewport_size({"width": width, "height": 800})
    assert report.evaluate("document.documentElement.scrollWidth") <= width
    box = report.locator(".stage").bounding_box()
    assert box is not None
    assert box["height"] < 0.7 * box["width"]


def test_without_scripts_the_still_picture_remains(browser: Browser, tmp_path: Path) -> None:
    path = tmp_path / "report.html"
    path.write_text(render(RESULT), encoding="utf-8")
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(path.as_uri())
    expect(page.locator(".still svg")).to_be_visible()
    expect(page.locator(".player")).to_be_hidden()
    context.close()


def test_the_picture_of_the_motion_opens_as_an_image(
    page: Page, tmp_path: Path, complaints: list[str]
) -> None:
    (tmp_path / "motion.svg").write_text(render_motion(RESULT) or "", encoding="utf-8")
    (tmp_path / "index.html").write_text("<img src=motion.svg>", encoding="utf-8")
    page.goto((tmp_path / "index.html").as_uri())
    assert page.evaluate("document.images[0].naturalWidth") == 960
    assert complaints == []
