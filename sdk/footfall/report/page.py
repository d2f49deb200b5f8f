"""The page: what is said first, the plots, the diagnostics, and how to compute it again."""

from collections.abc import Mapping
from typing import Any

from footfall.report.figures import Figure, convergence, homotopy, mesh_errors
from footfall.report.markup import Markup, el, join
from footfall.report.motion import motion_of
from footfall.report.plots import plot
from footfall.report.scales import scientific
from footfall.report.sections import again, modes, moving, numbered, remarks, section, trajectory
from footfall.report.shell import document
from footfall.report.simulated import render_simulation
from footfall.report.tables import checks, meshes, minima, pairs, passes, residuals, stages
from footfall.summary import VERDICTS, error_name, plural, published_mesh, words

_STANDING = {"converged": "good", "acceptable": "fair", "cancelled": "quiet"}
_PARTS = ("build", "solve", "refine", "certify")


def render(result: Mapping[str, Any], problem: Mapping[str, Any] | None = None) -> str:
    """One self-contained HTML page about a result.

    Parameters
    ----------
    result : dict
        A result's JSON, of a solve or of a simulation.
    problem : dict, optional
        What it came of; its numeric bounds are drawn and it is folded into the page.

    Returns
    -------
    str
        HTML that loads nothing and runs no script but its own.
    """
    if result.get("kind") == "simulation":
        return render_simulation(result, problem)
    figures: list[Figure] = []
    motion = motion_of(result)
    body = el(
        "main",
        _header(result),
        remarks(result),
        moving(motion),
        modes(result),
        trajectory(result, problem, figures),
        _steps(result),
        _certificate(result["certificate"]),
        _complementarity(result.get("complementarity")),
        _mesh(result["mesh_refinement"], figures),
        _solver(result),
        again(result, problem),
    )
    return document(result["name"], body, figures, motion)


def _header(result: Mapping[str, Any]) -> Markup:
    mesh = published_mesh(result)
    verdict = result["certificate"]["verdict"]
    facts = {
        "objective": scientific(result["objective"], 10),
        error_name(result): scientific(mesh.get("max_error"), 3),
        "mesh": plural(mesh["segments"], "segment") if mesh else "\N{EN DASH}",
        "certificate": VERDICTS[verdict],
        "time": f"{result['timing']['total']:.2f} s",
    }
    if told := result.get("mode_sequence"):
        facts["modes"] = f"{told['distinct']} of {scientific(told['possible'], 6)}"
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


def _steps(result: Mapping[str, Any]) -> Markup | None:
    """The stages solved in a row, and the distinct minima, where there are any."""
    found, several = result.get("stages", []), result.get("minima", [])
    if not found and not several:
        return None
    return section(
        "Stages and minima" if found and several else "Stages" if found else "Distinct minima",
        stages(found) if found else None,
        minima(several) if several else None,
    )


def _certificate(certificate: Mapping[str, Any]) -> Markup:
    verdict = certificate["verdict"]
    kind = {"certified": "good", "not_certified": "bad"}.get(verdict, "quiet")
    badge = el("span", VERDICTS[verdict], class_=f"badge {kind}")
    return section(
        "Certificate",
        el("p", badge, el("span", certificate["note"]), class_="status"),
        checks(certificate),
    )


def _complementarity(found: Mapping[str, Any] | None) -> Markup | None:
    """How contacts were brought to strict complementarity, pass by pass."""
    if not found:
        return None
    facts = {
        "form": words(found["form"]),
        "passes": str(len(found["passes"])),
        "residual": f"{scientific(found['residual'], 3)} (SI)",
        "polished": "yes" if found["polished"] else "no",
        "stationarity": found.get("stationarity"),
        "pinned gaps": str(found["pinned"]) if found.get("pinned") else None,
        "dissipated by the steps": _percent(found.get("dissipation")),
    }
    drawn = [plot(figure, None, "low") for figure in homotopy(found["passes"])]
    return section(
        "Complementarity",
        pairs({name: fact for name, fact in facts.items() if fact is not None}),
        el("div", *drawn, class_="pair") if drawn else None,
        passes(found["passes"]),
    )


def _percent(share: float | None) -> str | None:
    return None if share is None else f"{100 * share:.3g} % of the actuators' work"


def _mesh(refinement: Mapping[str, Any], figures: list[Figure]) -> Markup:
    errors = mesh_errors(refinement)
    history = [plot(figure, None, "low") for figure in convergence(refinement)]
    return section(
        "Mesh refinement",
        el("p", _mesh_words(refinement), class_="lead"),
        numbered(errors, figures, "tall") if errors else None,
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
    return section("Solver", pairs(facts), before, el("h3", "Time"), _timing(timing), worst)


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
