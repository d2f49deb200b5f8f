"""What commands print: JSON alone on stdout for programs, words for people."""

import argparse
import json
import os
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from footfall.cli import codes
from footfall.documents import find
from footfall.errors import BadFile, BadProblem, FootfallError, Issue
from footfall.report import render, render_motion, render_svg
from footfall.result import Result, SimulationResult
from footfall.simulated import simulation_in_words
from footfall.summary import in_words

_SHOWN = 76  # characters of a long expression around the caret


def show_json(document: Any) -> None:
    """One JSON document on stdout."""
    json.dump(document, sys.stdout, allow_nan=False, ensure_ascii=False)
    sys.stdout.write("\n")


def note(words: str) -> None:
    """A line for a person, on stderr."""
    print(words, file=sys.stderr)


def deliver(
    result: Result, options: argparse.Namespace, problem: Mapping[str, Any] | None = None
) -> int:
    """Print the result, write the files asked for, and give the exit code of its status."""
    if options.json:
        show_json(result.document)
    else:
        simulated = isinstance(result, SimulationResult)
        print((simulation_in_words if simulated else in_words)(result.document), flush=True)
    if options.output:
        write(options.output, json.dumps(result.document, allow_nan=False))
        note(f"result written to {options.output}")
    draw(result, options, problem)
    return codes.of_status(result.status)


def draw(
    result: Result, options: argparse.Namespace, problem: Mapping[str, Any] | None = None
) -> None:
    """Write the report and the pictures that were asked for."""
    if options.report:
        write(options.report, render(result.document, problem))
        note(f"report written to {options.report}")
    if options.picture:
        write(options.picture, render_svg(result.document, problem))
        note(f"picture written to {options.picture}")
    if options.motion:
        write(options.motion, motion(result))
        note(f"frames of the motion written to {options.motion}")


def motion(result: Result) -> str:
    """The picture of the motion. Raises ``BadFile`` where there is nothing to draw."""
    drawn = render_motion(result.document)
    if drawn is None:
        hint = "Results of mechanisms and URDF systems have frames; others have curves only."
        raise BadFile("The result has no frames of a motion.", hint)
    return drawn


def write(path: str, text: str) -> None:
    """A text file, its folder made if need be. Raises ``BadFile``."""
    target = Path(path)
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8")
    except OSError as error:
        raise BadFile(f"{path} cannot be written: {error.strerror}.") from error


def check_places(options: argparse.Namespace) -> None:
    """Raise ``BadFile`` now for a file that could not be written after a long solve."""
    paths = (options.output, options.report, options.picture, options.motion)
    for target in map(Path, filter(None, paths)):
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise BadFile(f"{target} cannot be written: {error.strerror}.") from error
        if target.is_dir() or not os.access(target if target.exists() else target.parent, os.W_OK):
            raise BadFile(f"{target} cannot be written.", "Name a file in a folder of yours.")


def complain(error: FootfallError, *, as_json: bool) -> None:
    """An error on stderr: words, or one JSON document for programs."""
    if not as_json:
        note(f"error: {error}")
        return
    document: dict[str, Any] = {"error": type(error).__name__, "message": error.message}
    document["hint"] = error.hint
    if isinstance(error, BadProblem):
        document["issues"] = [issue_json(issue) for issue in error.issues]
    note(json.dumps(document))


def issue_json(issue: Issue) -> dict[str, Any]:
    """An issue as JSON values."""
    return {
        "pointer": issue.pointer,
        "column": issue.column,
        "message": issue.message,
        "hint": issue.hint,
    }


def refuse(error: BadProblem, problem: Mapping[str, Any], options: argparse.Namespace) -> int:
    """Say what is wrong with a problem that was to be solved."""
    if options.json:
        raise error
    note(explain(error.issues, problem, options.file))
    return codes.BAD_INPUT


def explain(issues: Iterable[Issue], document: Mapping[str, Any], name: str) -> str:
    """Issues for a person: the place, the reason, the user's text with a caret, the mend."""
    return "\n\n".join(_explained(issue, document, name) for issue in issues)


def _explained(issue: Issue, document: Mapping[str, Any], name: str) -> str:
    lines = [f"{name}: {issue.pointer or '/'}: {issue.message}"]
    text = find(document, issue.pointer)
    if isinstance(text, str) and issue.column is not None:
        start = max(0, issue.column - 1 - _SHOWN // 2)
        lines.append(f"    {text[start : start + _SHOWN]}")
        lines.append(f"    {' ' * (issue.column - 1 - start)}^")
    if issue.hint:
        lines.append(f"  hint: {issue.hint}")
    return "\n".join(lines)
