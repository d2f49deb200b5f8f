"""Values put into a JSON document at JSON pointers (RFC 6901), without changing the document."""

from collections.abc import Mapping
from typing import Any

from schemas.pointers import parts_of
from schemas.suggest import did_you_mean


class NoPlace(ValueError):
    """The pointer leads nowhere: the reason, and the mend."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint


def replaced(document: Any, values: Mapping[str, Any]) -> Any:
    """The document with other values at places that it has. Raises NoPlace."""
    for place, value in values.items():
        document = _put(document, _parts(place), value)
    return document


def _parts(place: str) -> list[str]:
    if not place.startswith("/"):
        raise NoPlace("a JSON pointer begins with /", "such as '/phases/0/system/parameters/m1'")
    return parts_of(place)


def _put(document: Any, parts: list[str], value: Any) -> Any:
    if not parts:
        return value
    part, *rest = parts
    if isinstance(document, dict):
        if part not in document:
            raise NoPlace(f"the problem has no '{part[:64]}' here", _mend(part, document))
        return {**document, part: _put(document[part], rest, value)}
    if isinstance(document, list):
        if not (part.isdecimal() and len(part) < 10 and int(part) < len(document)):
            raise NoPlace(
                f"'{part[:64]}' is no place in a list of {len(document)}", "places count from 0"
            )
        at = int(part)
        return [*document[:at], _put(document[at], rest, value), *document[at + 1 :]]
    raise NoPlace(f"there is nothing below a plain value, at '{part[:64]}'")


def _mend(part: str, table: dict[str, Any]) -> str:
    near = did_you_mean(part, table)
    return near or "write a value there in 'problem'; each point then puts its own in its place"
