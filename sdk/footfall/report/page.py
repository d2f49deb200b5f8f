"""The page: what is said first, the plots, the diagnostics, and how to compute it again."""

import json
from base64 import b64encode
from collections.abc import Mapping, Sequence
from hashlib import sha256
from typing import Any

from footfall.report.drawing import pointer_data, script_json
from footfall.report.figures import TOGETHER, Figure, convergence, mesh_errors, trajectories
from footfall.report.markup import Markup, asset, el, join, void
from footfall.report.phases import COSTATES
from footfall.report.plots import plot
from footfall.report.scales import scientific
from footfall.report.tables import checks, meshes, minima, pairs, residuals, stages
from footfall.summary import VERDICTS, plural, published_mesh, words

_STANDING = {"converged": "good", "acceptable": "fair", "cancelled": "quiet"}
_PARTS = ("build", "solve", "refine", "certify")


def render(result: Mapping[str, Any], problem: Mapping[str, Any] | None = None) -> str:
    """One self-contained HTML page about a result.

    Parameters
    ----------
    result : dict
        A result's JSON (``schemas.results.Solution``).
    problem : dict, optional
        The problem; its numeric bounds are drawn and it is folded into the page.

    Returns
    -------
    str
        HTML that loads nothing and runs no script but its own.
    """
    figures: list[Figure] = []
    body = el(
        "main",
        _header(result),
        _remarks(result),
        _trajectory(result, problem, figures),
        _steps(result),
        _certificate(result["certificate"]),
        _mesh(result["mesh_refinement"], figures),
        _solver(result),
        _again(result, problem),
    )
    data = script_json([pointer_data(figure) for figure in figures])
    return _document(result["name"], body, data)


def _document(title: str, body: Markup, data: Markup) -> str:
    style, script = asset("figure.css") + asset("page.css"), asset("page.js")
    policy = (
        f"default-src 'none'; style-src {_hash(style)}; script-src {_hash(script)}; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )
    head = el(
        "head",
        void("meta", charset="utf-8"),
        void("meta", http_equiv="Content-Security-Policy", content=policy),
        void("meta", name="viewport", content="width=device-width, initial-scale=1"),
        void("meta", name="color-scheme", content="light dark"),
        void("link", rel="icon", href="data:,"),
        el("title", f"{title} \N{MIDDLE DOT} Footfall"),
        el("style", Markup(style)),
    )
    scripts = join(
        el("script", data, type="application/json", id="figures"), el("script", Markup(script))
    )
    return f"<!doctype html>\n{el('html', head, el('body', body, scripts), lang='en')}\n"


def _header(result: Mapping[str, Any]) -> Markup:
    mesh = published_mesh(result)
    verdict = result["certificate"]["verdict"]
    facts = {
        "objective": scientific(result["objective"], 10),
        "largest error": scientific(mesh.get("max_error"), 3),
        "mesh": plural(mesh["segments"], "segment") if mesh else "\N{EN DASH}",
        "certificate": VERDICTS[verdict],
        "time": f"{result['timing']['total']:.2f} s",
    }
    return el(
        "header",
        el("p", "Footfall report", class_="kicker"),
        el("h1", result["name"]),
        el(
            "p",
            el("span", words(result["status"]), class_=f"badge {_standing(result)}"),
            el("span", result["message"]),
            class_="status",
        ),
        pairs(facts),
    )


def _standing(result: Mapping[str, Any]) -> str:
    return _STANDING.get(result["status"], "bad")


def _remarks(result: Mapping[str, Any]) -> Markup | None:
    remarks = [
        *(el("li", text, class_="warning") for text in result.get("warnings", [])),
        *(el("li", text, class_="advice") for text in result.get("advice", [])),
    ]
    return el("ul", *remarks, class_="remarks") if remarks else None


def _trajectory(
    result: Mapping[str, Any], problem: Mapping[str, Any] | None, figures: list[Figure]
) -> Markup | None:
    """All phases over one time axis; the costates folded away."""
    all_phases = result["phases"]
    if not all_phases:
        return None
    found = list(trajectories(all_phases, problem))
    plots = {
        id(figure): _numbered(figure, figures, "low" if index else "tall")
        for index, figure in enumerate(found)
    }
    costates = [plots[id(figure)] for figure in found if figure.group == COSTATES]
    return _section(
        "Trajectory",
        _phases(all_phases)
        if len(all_phases) > 1
        else el("p", _span(all_phases[0]), class_="lead"),
        *(plots[id(figure)] for figure in found if figure.group != COSTATES),
        el("details", el("summary", "Costates"), *costates) if costates else None,
        *map(_integrals, all_phases),
        join(el("h3", "Static parameters"), _values(result["static"]))
        if result.get("static")
        else None,
    )


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


def _steps(result: Mapping[str, Any]) -> Markup | None:
    """The stages solved in a row, and the distinct minima, where there are any."""
    found, several = result.get("stages", []), result.get("minima", [])
    if not found and not several:
        return None
    return _section(
        "Stages and minima" if found and several else "Stages" if found else "Distinct minima",
        stages(found) if found else None,
        minima(several) if several else None,
    )


def _certificate(certificate: Mapping[str, Any]) -> Markup:
    verdict = certificate["verdict"]
    kind = {"certified": "good", "not_certified": "bad"}.get(verdict, "quiet")
    badge = el("span", VERDICTS[verdict], class_=f"badge {kind}")
    return _section(
        "Certificate",
        el("p", badge, el("span", certificate["note"]), class_="status"),
        checks(certificate),
    )


def _mesh(refinement: Mapping[str, Any], figures: list[Figure]) -> Markup:
    errors = mesh_errors(refinement)
    history = [plot(figure, None, "low") for figure in convergence(refinement)]
    return _section(
        "Mesh refinement",
        el("p", _mesh_words(refinement), class_="lead"),
        _numbered(errors, figures, "tall") if errors else None,
        el("div", *history, class_="pair") if history else None,
        meshes(refinement),
    )


def _mesh_words(refinement: Mapping[str, Any]) -> str:
    if refinement["tolerance"] is None:
        return "Refinement was off: one mesh, its error estimated."
    end = "is met" if refinement["converged"] else "is not met"
    count = plural(len(refinement["iterations"]), "mesh").replace("meshs", "meshes")
    return f"The tolerance of {scientific(refinement['tolerance'], 3)} {end} after {count}."


def _solver(result: Mapping[str, Any]) -> Markup:
    solver, timing = result["solver"], result["timing"]
    facts = {
        "backend": solver["backend"],
        "its own status": solver["status"],
        "strategy": words(solver.get("strategy", "default")),
        "iterations on the last mesh": solver["iterations"],
        "variables": solver["variables"],
        "constraints": solver["constraints"],
    }
    ranked = solver["residuals"]
    worst = join(el("h3", "Largest residuals"), residuals(ranked)) if ranked else None
    tried = [el("li", text) for text in solver.get("attempts", [])]
    before = join(el("h3", "Attempts before"), el("ol", *tried)) if tried else None
    return _section("Solver", pairs(facts), before, el("h3", "Time"), _timing(timing), worst)


def _timing(timing: Mapping[str, float]) -> Markup:
    whole = max(sum(timing[part] for part in _PARTS), 1e-9)
    bars, start = [], 0.0
    for index, part in enumerate(_PARTS):
        share = 100 * timing[part] / whole
        box = {"x": f"{start:.3f}%", "width": f"{share:.3f}%", "height": "100%"}
        bars.append(el("rect", el("title", part), class_=f"t{index}", **box))
        start += share
    bar = el("svg", *bars, class_="bar", height=10, role="img", aria_label="share of each part")
    return join(bar, pairs({part: f"{timing[part]:.3f} s" for part in (*_PARTS, "total")}))


def _again(result: Mapping[str, Any], problem: Mapping[str, Any] | None) -> Markup:
    record = result["reproduce"]
    facts = {"spec sha256": el("code", record["spec_sha256"])}
    facts |= {name: el("span", version) for name, version in record["versions"].items()}
    if record["seed"] is not None:
        facts["seed"] = el("span", record["seed"])
    how = el(
        "p",
        "Save the problem below as problem.json, then: ",
        el("code", "footfall solve problem.json"),
    )
    text = json.dumps(problem, indent=2, ensure_ascii=False) if problem is not None else ""
    folded = el("details", el("summary", "The problem"), el("pre", text)) if text else None
    return _section("Reproduce", how if text else None, pairs(facts), folded)


def _numbered(figure: Figure, figures: list[Figure], size: str) -> Markup:
    figures.append(figure)
    return plot(figure, len(figures) - 1, size)


def _section(title: str, *children: Markup | None) -> Markup:
    return el("section", el("h2", title), *children)


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"
