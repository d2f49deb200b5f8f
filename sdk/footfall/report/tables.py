"""The tables of the page."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from footfall.report.markup import Child, Markup, el
from footfall.report.scales import scientific
from footfall.summary import VERDICTS, degree_range, judgement, words


def checks(certificate: Mapping[str, Any]) -> Markup:
    """The checks of the certificate."""
    head = ["check", "value", "tolerance", "unit", "judgement", "worst at"]
    return grid(head, (_check(check) for check in certificate["checks"]), numeric={1, 2})


def meshes(refinement: Mapping[str, Any]) -> Markup:
    """One row for each mesh; degrees and switches only where some mesh has them."""
    history = refinement["iterations"]
    head = [
        "mesh",
        "segments",
        "largest error",
        "objective",
        "NLP iterations",
        "seconds",
        *["degrees"] * any(mesh.get("degrees") for mesh in history),
        *["switches [s]"] * any(mesh.get("switches") for mesh in history),
        "NLP status",
    ]
    more = {"degrees": _degrees, "switches [s]": _switches}
    rows = (
        [
            index + 1,
            mesh["segments"],
            scientific(mesh["max_error"], 3),
            scientific(mesh["objective"], 11),
            mesh["nlp_iterations"],
            f"{mesh['seconds']:.3f}",
            *(more[name](mesh) for name in head[6:-1]),
            mesh["status"].replace("_", " "),
        ]
        for index, mesh in enumerate(history)
    )
    return grid(head, rows, numeric=set(range(len(head) - 1)))


def _degrees(mesh: Mapping[str, Any]) -> str:
    return degree_range(mesh.get("degrees", []))


def _switches(mesh: Mapping[str, Any]) -> str:
    return ", ".join(scientific(time, 4) for time in mesh.get("switches", []))


def stages(reports: Sequence[Mapping[str, Any]]) -> Markup:
    """One row for each stage, in the order in which they were solved."""
    head = ["stage", "objective", "segments", "NLP iterations", "seconds", "status"]
    rows = (
        [
            index + 1,
            scientific(stage["objective"], 11),
            stage["segments"],
            stage["nlp_iterations"],
            f"{stage['seconds']:.3f}",
            words(stage["status"]),
        ]
        for index, stage in enumerate(reports)
    )
    return grid(head, rows, numeric={0, 1, 2, 3, 4})


def passes(reports: Sequence[Mapping[str, Any]]) -> Markup:
    """One row for each pass of the homotopy, in the order in which they were solved."""
    head = [
        *("relaxation", "form", "largest product", "objective", "NLP iterations"),
        *("seconds", "status"),
    ]
    rows = (
        [
            scientific(one["relaxation"], 3),
            words(one["form"]),
            scientific(one["residual"], 3),
            scientific(one["objective"], 11),
            one["nlp_iterations"],
            f"{one['seconds']:.3f}",
            words(one["status"]),
        ]
        for one in reports
    )
    return grid(head, rows, numeric={0, 2, 3, 4, 5})


def minima(found: Sequence[Mapping[str, Any]]) -> Markup:
    """One row for each distinct minimum, with the static parameters there."""
    chosen = list(dict.fromkeys(name for one in found for name in one.get("static", {})))
    head = ["minimum", "objective", *chosen, "status", "certificate", "guesses", "seeds"]
    rows: Iterable[list[Child]] = (
        [
            index + 1,
            scientific(one["objective"], 11),
            *(scientific(one.get("static", {}).get(name), 6) for name in chosen),
            words(one["status"]),
            VERDICTS[one["verdict"]],
            len(one["seeds"]),
            ", ".join(map(str, one["seeds"])),
        ]
        for index, one in enumerate(found)
    )
    width = len(chosen)
    return grid(head, rows, numeric={*range(2 + width), 4 + width})


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
