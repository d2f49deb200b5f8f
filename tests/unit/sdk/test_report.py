"""The report and the picture: complete, escaped, self-contained, whatever the result."""

import json
import re
import xml.etree.ElementTree as ET
from base64 import b64encode
from hashlib import sha256
from html.parser import HTMLParser
from typing import Any

import numpy as np
import pytest

from footfall.report import render, render_svg
from footfall.report.figures import mesh_errors, trajectories
from footfall.report.scales import Scale, linear, logarithmic, scientific

EVIL = "</script><script>alert(1)</script><img src=x onerror=alert(2)>&'\""

MINUS = "\N{MINUS SIGN}"


class Elements(HTMLParser):
    """Every element of a page with its attributes."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None]]] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))


def read_svg(picture: str) -> ET.Element:
    return ET.fromstring(picture)  # noqa: S314 - our own text


def copy(document: dict[str, Any]) -> dict[str, Any]:
    again: dict[str, Any] = json.loads(json.dumps(document))
    return again


def test_the_page_says_everything(solved: dict[str, Any], problem: dict[str, Any]) -> None:
    page = render(solved, problem)
    for words in ("cart-pole swing-up", "converged", "58.80767", "certified", "140 segments"):
        assert words in page
    for check in solved["certificate"]["checks"]:
        assert check["name"] in page
    for name in ("q1", "q2", "v1", "v2", "u"):
        assert f'data-name="{name}"' in page
    assert solved["reproduce"]["spec_sha256"] in page
    assert "&quot;minimize&quot;: &quot;effort&quot;" in page
    assert page.count('class="bound"') == 4


def test_the_page_loads_nothing_and_runs_only_its_own_script(solved: dict[str, Any]) -> None:
    page = render(solved)
    elements = Elements(page).found
    assert not [a for _, a in elements if a.get("src") or "style" in a]
    assert not [name for _, a in elements for name in a if name.startswith("on")]
    assert [a["href"] for t, a in elements if t == "link"] == ["data:,"]
    assert "http://" not in page.replace("http://www.w3.org/2000/svg", "")
    assert "https://" not in page
    policy = next(a["content"] for _, a in elements if a.get("http-equiv"))
    assert policy is not None
    assert "default-src 'none'" in policy
    for tag in ("style", "script"):
        (text,) = re.findall(rf"<{tag}>(.*?)</{tag}>", page, re.DOTALL)
        assert b64encode(sha256(text.encode()).digest()).decode() in policy


def test_user_text_is_escaped_everywhere(solved: dict[str, Any], problem: dict[str, Any]) -> None:
    document = copy(solved)
    document |= {"name": EVIL, "message": EVIL, "advice": [EVIL], "warnings": [EVIL]}
    phase = document["phases"][0]
    phase["name"] = EVIL
    phase["curves"]["states"]["coefficients"][EVIL] = phase["curves"]["states"]["coefficients"][
        "q1"
    ]
    phase["curves"][EVIL] = phase["curves"]["controls"]
    phase["integrals"] = {EVIL: 1.0}
    document["certificate"]["checks"][0] |= {"name": EVIL, "where": EVIL, "unit": EVIL}
    residual = {"name": EVIL, "phase": EVIL, "time": 0.5, "value": 1.0}
    document["solver"]["residuals"] = [residual]
    document["reproduce"]["versions"] = {EVIL: EVIL}
    page = render(document, problem | {"name": EVIL})
    tags = [tag for tag, _ in Elements(page).found]
    assert tags.count("script") == 2
    assert "img" not in tags
    read_svg(render_svg(document, problem))


def test_what_the_pointer_reads_is_the_result(solved: dict[str, Any]) -> None:
    found = re.search(r'id="figures">(.*?)</script>', render(solved), re.DOTALL)
    assert found
    figures = json.loads(found[1])
    assert len(figures) == 3
    rows = solved["phases"][0]["curves"]["states"]["coefficients"]["q1"]
    np.testing.assert_allclose(figures[0]["series"][0]["rows"], rows, rtol=1e-8, atol=1e-20)


def test_an_infeasible_result_has_a_report_too(infeasible: dict[str, Any]) -> None:
    page = render(infeasible)
    assert "locally infeasible" in page
    assert infeasible["solver"]["residuals"][0]["name"] in page
    read_svg(render_svg(infeasible))


def test_holes_are_drawn_as_holes(solved: dict[str, Any]) -> None:
    document = copy(solved)
    document["objective"] = None
    document["phases"][0]["groups"]["states"]["values"]["q1"][0] = None
    for mesh in document["mesh_refinement"]["iterations"]:
        mesh |= {"objective": None, "max_error": None}
        mesh["errors"] = [None, 0.0, *mesh["errors"][2:]]
    page = render(document)
    assert "NaN" not in re.sub(r"<script>.*?</script>", "", page, flags=re.DOTALL)
    assert "Infinity" not in page


def test_without_any_mesh_or_phase(solved: dict[str, Any]) -> None:
    document = copy(solved)
    document["phases"] = []
    document["mesh_refinement"] = {"tolerance": None, "converged": False, "iterations": []}
    assert "Refinement was off" in render(document)
    read_svg(render_svg(document))


def test_the_picture_is_one_standalone_svg(solved: dict[str, Any], problem: dict[str, Any]) -> None:
    picture = render_svg(solved, problem)
    root = read_svg(picture)
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    assert "prefers-color-scheme: dark" in picture
    assert picture.count('class="curve"') == 2 * (5 + 3)
    assert "href" not in picture


def test_a_jump_breaks_the_line() -> None:
    phase = {
        "curves": {"states": {"breaks": [0, 1, 2], "coefficients": {"v": [[1.0], [-1.0]]}}},
        "groups": {},
    }
    (figure,) = trajectories(phase, {})
    (series,) = figure.series
    assert np.isnan(series.value).sum() == 1
    assert series.value[np.flatnonzero(np.isnan(series.value))[0] - 1] == 1.0


def test_many_series_are_spread_over_plots_and_many_nodes_thinned() -> None:
    names = [f"x{i}" for i in range(14)]
    time = np.linspace(0, 1, 5001)
    flat = dict.fromkeys(names, [[0.0]] * 5000)
    phase = {
        "curves": {"states": {"breaks": time.tolist(), "coefficients": flat}},
        "groups": {"states": {"time": time.tolist(), "values": dict.fromkeys(names, [0.0] * 5001)}},
    }
    figures = list(trajectories(phase, {"x0": (1e6,)}))
    assert [len(figure.series) for figure in figures] == [6, 6, 2]
    nodes = figures[0].series[0].nodes
    assert nodes is not None
    assert len(nodes[0]) < 1600
    assert "every 4th node marked" in figures[0].notes
    assert "a bound of x0 lies outside of the picture" in figures[0].notes


def test_the_errors_of_each_mesh_are_steps_over_time(solved: dict[str, Any]) -> None:
    figure = mesh_errors(solved["mesh_refinement"])
    assert figure is not None
    assert figure.y.log
    for series, mesh in zip(figure.series, solved["mesh_refinement"]["iterations"], strict=True):
        middles = np.mean(mesh["spans"], axis=1)
        np.testing.assert_allclose(series.curve(middles), mesh["errors"])
    assert figure.series[-1].style == "m4"


@pytest.mark.parametrize(
    ("scale", "count", "labels"),
    [
        (Scale(-4.0, 9.0), 6, [f"{MINUS}4", f"{MINUS}2", "0", "2", "4", "6", "8"]),
        (Scale(0.0, 2.0), 10, [f"{k / 5:.1f}" for k in range(11)]),
        (Scale(0.7, 3.3, whole=True), 10, ["1", "2", "3"]),
        (Scale(1e-8, 1e-2, log=True), 4, ["10⁻⁸", "10⁻⁶", "10⁻⁴", "10⁻²"]),
    ],
)
def test_ticks_are_round_numbers(scale: Scale, count: int, labels: list[str]) -> None:
    assert [label for _, label in scale.ticks(count)] == labels


@pytest.mark.parametrize(
    "values", [[], [0.0], [5.0, 5.0], [1e300, -1e300], [float("nan")], [1e-300]]
)
def test_every_axis_has_a_height(values: list[float]) -> None:
    for scale in (linear(values), logarithmic(values)):
        assert scale.high > scale.low
        assert len(scale.ticks(5)) < 20


def test_numbers_are_set_for_reading() -> None:
    assert scientific(8.512e-7, 3) == "8.51 \N{MULTIPLICATION SIGN} 10⁻⁷"
    assert scientific(1e-5, 3) == "10⁻⁵"
    assert scientific(-0.25, 3) == f"{MINUS}0.25"
    assert scientific(None, 3) == "\N{EN DASH}"
