"""The tables of the page."""

from collections.abc import Iterable, Mapping
from typing import Any

from footfall.report.markup import Child, Markup, el
from footfall.report.scales import scientific
from footfall.summary import judgement


def checks(certificate: Mapping[str, Any]) -> Markup:
    """The checks of the certificate."""
    head = ["check", "value", "tolerance", "unit", "judgement", "worst at"]
    return grid(head, (_check(check) for check in certificate["checks"]), numeric={1, 2})


def meshes(refinement: Mapping[str, Any]) -> Markup:
    """One row for each mesh."""
    head = [
        "mesh",
        "segments",
        "largest error",
        "objective",
        "NLP iterations",
        "seconds",
        "NLP status",
    ]
    rows = (
        [
            index + 1,
            mesh["segments"],
            scientific(mesh["max_error"], 3),
            scientific(mesh["objective"], 11),
            mesh["nlp_iterations"],
            f"{mesh['seconds']:.3f}",
            mesh["status"].replace("_", " "),
        ]
        for index, mesh in enumerate(refinement["iterations"])
    )
    return grid(head, rows, numeric={0, 1, 2, 3, 4, 5})


def residuals(ranked: Iterable[Mapping[str, Any]]) -> Markup:
    """What is violated most, the worst first."""
    rows = (
        [r["name"], scientific(r["value"], 3), r["phase"], scientific(r["time"], 5)] for r in ranked
    )
    return grid(["constraint", "violation", "phase", "time [s]"], rows, numeric={1, 3})


def pairs(table: Mapping[str, Child]) -> Markup:
    """Names and values."""
    cells = (el("div", el("dt", name), el("dd", value)) for name, value in table.items())
    return el("dl", *cells)


def grid(head: list[str], rows: Iterable[list[Child]], numeric: set[int]) -> Markup:
    """A table; the columns in ``numeric`` are set flush right."""
    kinds = ["number" if index in numeric else None for index in range(len(head))]
    top = el(
        "tr", *(el("th", text, class_=k, scope="col") for text, k in zip(head, kinds, strict=True))
    )
    body = [
        el("tr", *(el("td", cell, class_=k) for cell, k in zip(row, kinds, strict=True)))
        for row in rows
    ]
    return el("div", el("table", el("thead", top), el("tbody", *body)), class_="scroll")


def _check(check: Mapping[str, Any]) -> list[Child]:
    said = judgement(check)
    kind = {"passed": "good", "FAILED": "bad"}.get(said, "quiet")
    return [
        check["name"],
        scientific(check["value"], 3),
        scientific(check["tolerance"], 3),
        check["unit"],
        el("span", said.lower(), class_=f"mark {kind}"),
        check.get("where"),
    ]
