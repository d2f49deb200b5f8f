"""``python -m benchmarks.reproduce [--only SECTION] [--output FILE]``: see the package."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from benchmarks.reproduce.document import write
from benchmarks.reproduce.judge import judge
from benchmarks.reproduce.measure import measure
from benchmarks.reproduce.pictures import draw_hoppers
from benchmarks.reproduce.rows import Measured, Table
from benchmarks.reproduce.tables import TABLES

DOCUMENT = Path("docs/reproduction.md")
PICTURE = Path("docs/images/slip.svg")


def main(arguments: Sequence[str] | None = None) -> int:
    """Solve, write, and say with the exit code whether all came out as it should."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.reproduce")
    parser.add_argument(
        "--only", help="sections that begin so, such as 8.8; prints, writes no file"
    )
    parser.add_argument("--output", type=Path, help=f"where to write, instead of {DOCUMENT}")
    options = parser.parse_args(arguments)
    tables = [table for table in TABLES if table.section.startswith(options.only or "")]
    if not tables:
        known = ", ".join(table.section for table in TABLES)
        parser.error(f"no section begins with {options.only}; there are {known}")
    found = [(table, _measured(table)) for table in tables]
    text = write(found)
    if options.output or not options.only:
        (options.output or DOCUMENT).write_text(text, encoding="utf-8")
    else:
        print(text)
    if not options.only:
        draw_hoppers(PICTURE)
    return int(
        any(
            not judge(row, one).passed
            for table, all_ in found
            for row, one in zip(table.rows, all_, strict=True)
        )
    )


def _measured(table: Table) -> list[Measured]:
    results = []
    for row in table.rows:
        results.append(measure(row))
        verdict = judge(row, results[-1])
        mark = "ok  " if verdict.passed else "FAIL"
        print(f"{mark} {table.section} {row.name}: {verdict.words}", file=sys.stderr, flush=True)
    return results


if __name__ == "__main__":
    sys.exit(main())
