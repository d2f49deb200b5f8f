"""``footfall report``: the page and the pictures of a result that was kept."""

import argparse

from footfall.cli import codes
from footfall.cli.output import check_places, draw
from footfall.documents import read_json
from footfall.report import render
from footfall.result import Result


def report(options: argparse.Namespace) -> int:
    """Draw a result; the page on stdout where no file is named."""
    check_places(options)
    result = Result.load(options.file)
    problem = read_json(options.problem) if options.problem else None
    if not (options.report or options.picture or options.motion):
        print(render(result.document, problem), end="")
    draw(result, options, problem)
    return codes.CONVERGED
