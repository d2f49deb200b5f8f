"""The console in a real browser, over a whole service: post, see it end, open the report."""

import json
import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

import examples
from footfall import Client
from footfall.serving import ServeSettings, Service

pytestmark = pytest.mark.browser

SECONDS = 30_000  # ms, for a job to end on a busy machine


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    folder = tmp_path_factory.mktemp("console")
    with Service(ServeSettings(port=0, folder=folder)) as service:
        yield service.url


@pytest.fixture
def console(browser: Browser, url: str, complaints: list[str]) -> Iterator[Page]:
    page = browser.new_page(viewport={"width": 1200, "height": 900})
    page.on("console", lambda message: complaints.append(f"{message.type}: {message.text}"))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(url)
    expect(page.locator("#problem")).not_to_have_value("")
    yield page
    page.close()


def replace(page: Page, old: str, new: str) -> None:
    """Edit the problem as a person would."""
    page.locator("#post-form summary").click()
    area = page.locator("#problem")
    text = area.input_value()
    assert old in text
    area.fill(text.replace(old, new, 1))


def test_it_shows_what_there_is(console: Page, complaints: list[str]) -> None:
    expect(console.locator("#state")).to_contain_text("Workers: 1")
    names = [*examples.names(), *examples.simulations()]
    assert console.locator("#example option").count() == len(names)
    console.select_option("#example", "cart_pole")
    expect(console.locator("#about")).to_contain_text("cart")
    assert complaints == []


def test_an_example_is_posted_seen_to_end_and_reported(
    console: Page, complaints: list[str]
) -> None:
    console.select_option("#example", "cart_pole")
    expect(console.locator("#problem")).to_have_value(re.compile("cart-pole swing-up"))
    console.get_by_role("button", name="Run").click()
    expect(console.locator("#answer")).to_contain_text("Queued as")
    row = console.locator("#jobs tr").first
    expect(row).to_contain_text("cart-pole swing-up")
    expect(row).to_contain_text("succeeded", timeout=SECONDS)
    expect(row).to_contain_text("converged")
    expect(row).to_contain_text("objective 58.8076")
    row.get_by_role("link", name="report.html").click()
    expect(console.locator("header .badge")).to_have_text("converged")
    assert console.locator("path.curve").count() > 4
    assert complaints == []


def test_a_simulation_is_posted_and_its_motion_shown(console: Page, complaints: list[str]) -> None:
    console.select_option("#example", "bouncing_ball")
    expect(console.locator("#problem")).to_have_value(re.compile("bouncing ball"))
    console.get_by_role("button", name="Run").click()
    row = console.locator("#jobs tr").first
    expect(row).to_contain_text("bouncing ball")
    expect(row).to_contain_text("simulation, ")
    expect(row).to_contain_text("succeeded", timeout=SECONDS)
    expect(row).to_contain_text("finished")
    row.get_by_role("link", name="report.html").click()
    expect(console.locator(".player")).to_be_visible()
    console.get_by_role("button", name="Play").click()
    expect(console.locator(".clock")).not_to_have_text("0.000 s")
    assert complaints == []


def test_an_edited_problem_is_the_one_that_is_solved(console: Page, url: str) -> None:
    replace(console, '"name": "', '"name": "mine: <b>')
    console.get_by_role("button", name="Run").click()
    expect(console.locator("#jobs tr").first).to_contain_text("mine: <b>")
    expect(console.locator("#jobs tr").first).to_contain_text("succeeded", timeout=SECONDS)
    with Client(url) as client:
        job_id = console.locator("#jobs tr").first.get_attribute("id") or ""
        assert client.result(job_id).document["name"].startswith("mine: <b>")


def test_a_sweep_shows_its_points(console: Page, url: str, complaints: list[str]) -> None:
    with Client(url) as client:
        problem = examples.load("block_min_force") | {"name": "<b>bold</b>"}
        client.wait_sweep(client.sweep(problem, grid={"/phases/0/time/final": [1, 2]}).id)
    sweep = console.locator("#sweeps details").first
    expect(sweep).to_contain_text("<b>bold</b>: succeeded, 2 of 2 points", timeout=SECONDS)
    sweep.locator("summary").click()
    expect(sweep.locator("tr").nth(2)).to_contain_text("1.5000000")
    expect(sweep.locator("tr").nth(2)).to_contain_text("converged")
    assert sweep.get_by_role("link", name="result").count() == 2
    assert complaints == []


def test_a_refused_problem_names_place_reason_and_mend(console: Page) -> None:
    console.select_option("#example", "cart_pole")
    expect(console.locator("#problem")).to_have_value(re.compile("cart-pole swing-up"))
    expect(console.locator("#problem")).to_have_value(re.compile("cart-pole swing-up"))
    replace(console, '"effort": "u^2"', '"effort": "uu^2"')
    console.get_by_role("button", name="Run").click()
    issue = console.locator("#issues li")
    expect(issue).to_contain_text("/phases/0/integrals/effort, column 1: unknown name 'uu'")
    expect(issue).to_contain_text("did you mean 'u'?")
    console.locator("#problem").fill("{")
    console.get_by_role("button", name="Run").click()
    expect(issue).to_contain_text("not JSON")


def test_a_running_job_is_cancelled(console: Page) -> None:
    slow = examples.load("cart_pole") | {"refinement": None, "solver": {"tolerance": 1.1e-14}}
    slow["method"] = {"kind": "trapezoidal", "segments": 5000}
    console.locator("#post-form summary").click()
    console.locator("#problem").fill(json.dumps(slow))
    console.get_by_role("button", name="Run").click()
    row = console.locator("#jobs tr").first
    expect(row).to_contain_text("running", timeout=SECONDS)
    row.get_by_role("button", name="cancel").click()
    expect(row).to_contain_text("cancelled", timeout=SECONDS)


@pytest.mark.parametrize("width", [360, 1200])
def test_it_fits_every_width(console: Page, width: int) -> None:
    console.set_viewport_size({"width": width, "height": 800})
    assert console.evaluate("document.documentElement.scrollWidth") <= width
