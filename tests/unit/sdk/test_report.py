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
    document["phases"].append(copy(phase))
    document["static"] = {EVIL: 1.0}
    document["solver"] |= {"strategy": EVIL, "attempts": [EVIL]}
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
    drawn = list(trajectories(solved["phases"]))
    assert len(figures) == len(drawn) + 1
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
    meshes = len(solved["mesh_refinement"]["iterations"])
    assert picture.count('class="curve"') == 2 * (5 + meshes)
    assert "href" not in picture


def phase_of(name: str, start: float, end: float, **states: list[list[float]]) -> dict[str, Any]:
    """A phase on segments of one length, with nodes at its knots."""
    count = len(next(iter(states.values())))
    knots = np.linspace(start, end, count + 1).tolist()
    curves = {"states": {"breaks": knots, "coefficients": states}}
    nodes = {series: [0.0] * len(knots) for series in states}
    groups = {"states": {"time": knots, "values": nodes}}
    return {"name": name, "knots": knots, "curves": curves, "groups": groups}


def several(solved: dict[str, Any]) -> dict[str, Any]:
    """A result of three phases by hand: the one in the middle has a state less, and one more."""
    document = copy(solved)
    stance = phase_of("stance", 0, 1, x=[[0.5, 0.5], [1.5, 0.5]], y=[[1.0], [1.0]])
    flight = phase_of("flight", 1, 1.5, x=[[3.0, 0.5, 0.0]], z=[[2.0]])
    landing = phase_of("landing", 1.5, 1.5 + 1e-3, x=[[4.0]], y=[[-1.0]])
    stance["groups"]["rates"] = {"time": [0.0, 0.5, 1.0], "values": {"d(u)": [0.0, 1.0, None]}}
    stance["groups"]["costates"] = {"time": [0.1, 0.9], "values": {"x": [2.0, 4.0]}}
    stance["integrals"] = {"work": 0.25}
    document |= {
        "phases": [stance, flight, landing],
        "static": {"stiffness": 12.5, "unknown": None},
        "stages": [
            {
                "status": status,
                "objective": objective,
                "nlp_iterations": 7,
                "segments": 11,
                "seconds": 0.125,
            }
            for status, objective in (("iteration_limit", None), ("converged", 2.5))
        ],
        "minima": [
            {
                "objective": objective,
                "status": "converged",
                "verdict": verdict,
                "seeds": seeds,
                "static": {"stiffness": 12.5},
                "phases": [],
            }
            for objective, verdict, seeds in (
                (57.94478, "certified", [1, 4, 9]),
                (303.25, "not_certified", [2]),
            )
        ],
    }
    for mesh in document["mesh_refinement"]["iterations"]:
        mesh |= {"degrees": [3, 4, 8], "switches": [0.75]}
    document["solver"] |= {"strategy": "adaptive_mu", "attempts": ["default: locally infeasible"]}
    return document


def test_a_jump_breaks_the_line() -> None:
    (figure,) = trajectories([phase_of("swing", 0, 2, v=[[1.0, 0.5], [-1.0, 0.5]])])
    (series,) = figure.series
    assert np.isnan(series.value).sum() == 1
    assert series.value[np.flatnonzero(np.isnan(series.value))[0] - 1] == 1.5
    assert figure.bands == []


def test_steps_are_stairs() -> None:
    (figure,) = trajectories([phase_of("swing", 0, 2, v=[[1.0], [-1.0]])])
    (series,) = figure.series
    assert series.value[series.time == 1.0].tolist() == [1.0, -1.0]
    assert np.isfinite(series.value).all()


def test_time_goes_on_from_phase_to_phase(solved: dict[str, Any]) -> None:
    figures = {figure.group: figure for figure in trajectories(several(solved)["phases"])}
    states = figures["states"]
    x, y, z = (item.curve for item in states.series)
    np.testing.assert_allclose(x([0.25, 0.75, 1.25, 1.5]), [0.5, 1.5, 3.0, 4.0])
    np.testing.assert_array_equal(y([0.5, 1.25, 1.5]), [1.0, np.nan, -1.0])
    np.testing.assert_array_equal(z([0.5, 1.25, 1.5005]), [np.nan, 2.0, np.nan])
    assert (states.x.low, states.x.high) == (0.0, 1.501)
    assert [(band.name, band.start) for band in states.bands] == [
        ("stance", 0.0),
        ("flight", 1.0),
        ("landing", 1.5),
    ]
    assert all(figure.x == states.x for figure in figures.values())


def test_a_line_ends_where_its_phase_ends(solved: dict[str, Any]) -> None:
    figure = next(trajectories(several(solved)["phases"]))
    y = figure.series[1]
    drawn = y.time[np.isfinite(y.value)]
    assert drawn.min() == 0.0
    assert drawn[drawn < 1.5].max() == 1.0
    assert not np.any((drawn > 1.0) & (drawn < 1.5))


def test_series_without_curves_are_drawn_through_their_nodes(solved: dict[str, Any]) -> None:
    figures = {figure.group: figure for figure in trajectories(several(solved)["phases"])}
    (costate,) = figures["costates"].series
    assert costate.label == "costate of x"
    np.testing.assert_allclose(costate.curve([0.1, 0.5, 0.7]), [2.0, 3.0, 3.5])
    (rate,) = figures["rates"].series
    assert rate.curve(0.25) == 0.5
    assert np.isnan(rate.curve(0.75))


def test_bounds_hold_in_their_own_phase_and_not_for_costates(solved: dict[str, Any]) -> None:
    problem = {"phases": [{"name": "stance", "bounds": {"x": [0, 3]}}, {"name": "flight"}]}
    figures = {f.group: f for f in trajectories(several(solved)["phases"], problem)}
    levels = figures["states"].series[0].limits
    assert [(level.value, level.start, level.end) for level in levels] == [(0, 0, 1), (3, 0, 1)]
    assert figures["costates"].series[0].limits == ()


def test_the_page_of_several_phases(solved: dict[str, Any]) -> None:
    page = render(several(solved))
    assert page.count('class="band s1"') == 3  # states, rates, costates
    for name in ("stance", "flight"):
        assert page.count(f'class="phase" x="{33.311 if name == "stance" else 83.278}%"') == 3
    assert "landing</text>" not in page  # too narrow for its name, but its tint tells it
    assert "<title>landing</title>" in page
    assert "flight: 1 to 1.5 s, 1 segment" in page
    assert "Integrals of stance" in page
    folded = re.search(r"<details><summary>Costates</summary>(.*?)</details>", page, re.DOTALL)
    assert folded
    assert folded[1].count("<figure>") == 1
    read_svg(render_svg(several(solved)))


def test_the_tables_of_a_result_that_went_through_more(solved: dict[str, Any]) -> None:
    text = re.sub(r"<[^>]+>", "|", re.sub(r"<(style|script).*?</\1>", "", render(several(solved))))
    text = re.sub(r"\|+", "|", text)
    for row in (
        "|stiffness|12.5|unknown|\N{EN DASH}|",
        "|1|\N{EN DASH}|11|7|0.125|iteration limit|2|2.5|11|7|0.125|converged|",
        "|1|57.94478|12.5|converged|certified|3|1, 4, 9|",
        "|2|303.25|12.5|converged|NOT certified|1|2|",
        "|degrees|switches [s]|NLP status|",
        "|3 to 8|0.75|",
        "|strategy|adaptive mu|",
        "|default: locally infeasible|",
    ):
        assert row in text, row


def test_a_result_of_one_stage_has_no_table_of_stages(solved: dict[str, Any]) -> None:
    page = render(copy(solved) | {"stages": [], "minima": [], "static": {}})
    for head in ("Stages", "Distinct minima", "Static parameters", 'class="band'):
        assert head not in page


def test_many_series_are_spread_over_plots_and_many_nodes_thinned() -> None:
    names = [f"x{i}" for i in range(14)]
    phase = phase_of("swing", 0, 1, **dict.fromkeys(names, [[0.0]] * 5000))
    problem = {"phases": [{"name": "swing", "bounds": {"x0": 1e6}}]}
    figures = list(trajectories([phase], problem))
    assert [len(figure.series) for figure in figures] == [4, 5, 5]
    nodes = figures[0].series[0].nodes
    assert nodes is not None
    assert len(nodes[0]) < 1600
    assert "every 4th node marked" in figures[0].notes
    assert "some bounds of x0 lie outside of the picture" in figures[0].notes


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
