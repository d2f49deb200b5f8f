"""``footfall solve``, ``footfall simulate`` and ``footfall validate``."""

import argparse
import sys
from collections.abc import Callable
from typing import Any

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
from footfall.documents import is_simulation, read_json
from footfall.errors import BadFile, BadProblem
from footfall.result import Result


def solve(options: argparse.Namespace) -> int:
    """Solve in this process, or through a service; the first Ctrl-C keeps the best iterate."""
    problem = read_json(options.file)
    if is_simulation(problem):
        words = f"{options.file} holds a simulation: a system without phases."
        raise BadFile(words, f"footfall simulate {options.file}")
    return _run(options, problem, local.solve)


def simulate(options: argparse.Namespace) -> int:
    """Simulate in this process, or through a service; the first Ctrl-C keeps what there is."""
    simulation = read_json(options.file)
    if "phases" in simulation:
        words = f"{options.file} holds a problem: it has phases."
        raise BadFile(words, f"footfall solve {options.file}")
    return _run(options, simulation, local.simulate)


def _run(options: argparse.Namespace, document: dict[str, Any], work: Callable[..., Result]) -> int:
    check_places(options)
    if options.server:
        return jobs.run_through(options, document)
    try:
        with Interrupt() as interrupt, progress(sys.stderr) as shown:
            result = work(document, on_event=shown, should_stop=interrupt.asked)
    except BadProblem as error:
        return refuse(error, document, options)
    code = deliver(result, options, document)
    return codes.INTERRUPTED if interrupt.asked() else code


def validate(options: argparse.Namespace) -> int:
    """Check a problem or simulation; print every issue with its place in the user's own text."""
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
