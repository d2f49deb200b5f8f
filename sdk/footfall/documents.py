"""Reading the JSON files that people give us, with errors that show the place."""

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NoReturn

from footfall.errors import BadFile

Problem = Mapping[str, Any] | str | Path
"""A problem: the document itself, or the path of a JSON file ("-": standard input)."""

_MEND = (
    "Names and texts stand in double quotes, commas between items and none after the last; "
    "there are no comments."
)


def read_problem(source: Problem) -> dict[str, Any]:
    """The problem as a dict; a path is read. Raises ``BadFile``."""
    return dict(source) if isinstance(source, Mapping) else read_json(source)


def is_simulation(document: Mapping[str, Any]) -> bool:
    """Whether a document is a simulation: it has a system of its own, and no phases."""
    return "system" in document and "phases" not in document


def read_json(path: str | Path) -> dict[str, Any]:
    """The object in a JSON file, or on standard input for ``-``.

    Raises
    ------
    BadFile
        If there is no such file, it cannot be read, or it holds no JSON object; a mistake in the
        JSON is shown with its line and a caret.
    """
    name, text = read_text(path)
    try:
        document = json.loads(text, parse_constant=_no_constant, object_pairs_hook=_no_repeats)
    except json.JSONDecodeError as error:
        raise BadFile(f"{name} is not JSON: {error.msg}", _place(text, error)) from error
    except (_Objection, RecursionError) as error:
        reason = str(error) if isinstance(error, _Objection) else "it is nested too deeply"
        raise BadFile(f"{name} is not usable JSON: {reason}.") from error
    if not isinstance(document, dict):
        raise BadFile(f"{name} holds {_kind(document)}, not a JSON object {{...}}.")
    return document


def read_text(path: str | Path) -> tuple[str, str]:
    """What to call a file, and its text. Raises ``BadFile``."""
    name = "standard input" if str(path) == "-" else str(path)
    try:
        data = sys.stdin.buffer.read() if str(path) == "-" else Path(path).read_bytes()
        return name, data.decode("utf-8-sig")
    except FileNotFoundError as error:
        hint = "'footfall examples' lists problems to start from."
        raise BadFile(f"There is no file {name}.", hint) from error
    except IsADirectoryError as error:
        raise BadFile(f"{name} is a directory.", "Name a JSON file in it.") from error
    except (OSError, ValueError) as error:
        reason = "it is not UTF-8 text" if isinstance(error, UnicodeDecodeError) else str(error)
        raise BadFile(f"{name} cannot be read: {reason}.") from error


def find(document: Any, pointer: str) -> Any:
    """What a JSON pointer (RFC 6901) points at, or None."""
    for part in pointer.split("/")[1:]:
        key = part.replace("~1", "/").replace("~0", "~")
        if isinstance(document, Mapping):
            document = document.get(key)
        elif isinstance(document, list) and key.isdecimal() and int(key) < len(document):
            document = document[int(key)]
        else:
            return None
    return document


class _Objection(ValueError):
    """The text is JSON by Python's lights, not by ours."""


def _no_constant(name: str) -> NoReturn:
    raise _Objection(f"{name} is no JSON number")


def _no_repeats(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    table: dict[str, Any] = {}
    for key, value in pairs:
        if key in table:
            raise _Objection(f'the key "{key}" comes twice in one object')
        table[key] = value
    return table


def _place(text: str, error: json.JSONDecodeError) -> str:
    line = text.splitlines()[error.lineno - 1] if error.lineno <= len(text.splitlines()) else ""
    start = max(0, error.colno - 60)
    caret = " " * (error.colno - 1 - start) + "^"
    shown = line[start : start + 90]
    return f"line {error.lineno}, column {error.colno}:\n  {shown}\n  {caret}\n{_MEND}"


def _kind(document: Any) -> str:
    kinds = {list: "a list", str: "a string", bool: "true or false", type(None): "null"}
    return kinds.get(type(document), "a number")
