"""Writes what was measured as markdown."""

import platform
from collections.abc import Sequence
from importlib.metadata import version

from benchmarks.reproduce.judge import judge
from benchmarks.reproduce.rows import Measured, Row, Table

HEAD = """# What the seeds print, and what we find

Made by `make reproduce`, which solves everything below from nothing and fails where a row that
should match does not. `python -m benchmarks.reproduce --only 8.8` does one section.

- **printed**: the seed's value and seconds; empty where it prints none.
- **ours**: on the seed's mesh; `error` is the mesh error there, the seconds are for building and
  solving, without the certificate.
- **refined**: the same method on meshes refined until the error is small. **J\\***: the optimum of
  the continuous problem, in closed form or from several high-order methods.
"""

_COLUMNS = ("case", "printed", "ours", "refined", "J*", "segments", "error", "printed s", "our s")


def write(found: Sequence[tuple[Table, Sequence[Measured]]]) -> str:
    """The whole document; the same numbers give the same text."""
    parts = [HEAD, *(_section(table, results) for table, results in found), _machine()]
    return "\n".join(parts)


def _section(table: Table, results: Sequence[Measured]) -> str:
    lines = [f"## {table.section}: {table.title}", "", table.about, "", _line((*_COLUMNS, "note"))]
    lines.append("|" + "---|" * (len(_COLUMNS) + 1))
    pairs = zip(table.rows, results, strict=True)
    return "\n".join([*lines, *(_line(_cells(row, result)) for row, result in pairs), ""])


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def _cells(row: Row, found: Measured) -> tuple[str, ...]:
    verdict = judge(row, found)
    words = row.why if verdict.passed else f"**fails**: {verdict.words}"
    segments = str(found.segments)
    if found.refined_segments is not None:
        segments += f", {found.refined_segments}"
    return (
        row.name,
        row.printed,
        _number(found.objective),
        _number(found.refined),
        _number(row.optimum),
        segments,
        "" if found.error is None else f"{found.error:.1e}",
        row.printed_seconds,
        f"{found.seconds:.2f}",
        ". ".join(word for word in (found.note, words) if word),
    )


def _number(value: float | None) -> str:
    if value is None:
        return ""
    return "0" if abs(value) < 5e-10 else f"{value:.8g}"


def _machine() -> str:
    packages = ", ".join(f"{name} {version(name)}" for name in ("casadi", "numpy", "scipy"))
    return (
        f"Measured with Python {platform.python_version()}, {packages}, on {platform.machine()}.\n"
    )
