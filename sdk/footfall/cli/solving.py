"""``footfall solve`` and ``footfall validate``."""

import argparse
import sys

from footfall import local
from footfall.cli import codes, jobs
from footfall.cli.interrupt import Interrupt
from footfall.cli.output import (
    check_places,
    deliver,
    explain,
    issue_json,
    note,
    refuse,
    show_json,
)
from footfall.cli.progress import progress
from footfall.documents import read_json
from footfall.errors import BadProblem


def solve(options: argparse.Namespace) -> int:
    """Solve in this process, or through a service; the first Ctrl-C keeps the best iterate."""
    problem = read_json(options.file)
    check_places(options.output, options.report)
    if options.server:
        return jobs.solve_through(options, problem)
    try:
        with Interrupt() as interrupt, progress(sys.stderr) as shown:
            result = local.solve(problem, on_event=shown, should_stop=interrupt.asked)
    except BadProblem as error:
        return refuse(error, problem, options)
    code = deliver(
        result, as_json=options.json, output=options.output, report=options.report, problem=problem
    )
    return codes.INTERRUPTED if interrupt.asked() else code


def validate(options: argparse.Namespace) -> int:
    """Check a problem; print every issue with its place in the user's own text."""
    problem = read_json(options.file)
    if options.server:
        with jobs.client(options) as client:
            issues, warnings = client.check(problem)
    else:
        issues, warnings = local.check(problem)
    if options.json:
        told = [issue_json(issue) for issue in issues]
        show_json({"valid": not issues, "issues": told, "warnings": warnings})
    elif issues:
        note(explain(issues, problem, options.file))
    else:
        print(f"{options.file}: fine")
        for text in warnings:
            print(f"  warning: {text}")
    return codes.BAD_INPUT if issues else codes.CONVERGED
