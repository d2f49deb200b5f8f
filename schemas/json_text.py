"""JSON as text to plain values, and everything that makes a document unfit to be read on."""

import json
import math
from collections.abc import Iterator
from typing import Any

from schemas.errors import Issue
from schemas.expressions.errors import quoted
from schemas.limits import MODEL_LIMITS
from schemas.pointers import Part, pointer

_MEND = (
    "names and texts stand in double quotes, commas between items and none after the last; "
    "there are no comments"
)
_LONGEST_INTEGER = 310  # digits; a longer one is infinite as a float


class _Repeating(dict[str, Any]):
    """An object that gave a key more than once; ``repeated`` holds these keys."""

    repeated: list[str]


def decode(data: bytes | str) -> tuple[Any, Issue | None]:
    """The value that the text stands for, or the reason why it stands for none.

    NaN, infinities and repeated keys come through, for `faults` to report with their place.
    """
    try:
        text = data if isinstance(data, str) else data.decode("utf-8-sig")
        return json.loads(text, object_pairs_hook=_object, parse_int=_integer), None
    except UnicodeDecodeError as error:
        return None, Issue("", f"not UTF-8: byte {error.start} does not decode")
    except json.JSONDecodeError as error:
        if not error.doc.strip():
            return None, Issue("", "the document is empty", "send a problem as JSON")
        place = f"line {error.lineno}, column {error.colno}"
        return None, Issue("", f"not JSON: {error.msg} at {place}", _MEND)
    except RecursionError:
        return None, _too_deep()


def faults(document: Any) -> Iterator[Issue]:
    """What no problem may hold: NaN, infinities, repeated keys, foreign types, too much of it."""
    pending: list[tuple[Any, tuple[Part, ...]]] = [(document, ())]
    count = 0
    while pending:
        value, parts = pending.pop()
        count += 1
        if count > MODEL_LIMITS.values:
            yield Issue("", f"over the limit 'values': more than {MODEL_LIMITS.values}")
            return
        if len(parts) > MODEL_LIMITS.nesting:
            yield _too_deep()
            return
        if isinstance(value, dict):
            yield from _key_faults(value, parts)
            items: list[tuple[Part, Any]] = [(k, v) for k, v in value.items() if _is_text(k)]
        elif isinstance(value, list | tuple):
            items = list(enumerate(value))
        else:
            yield from _leaf_faults(value, parts)
            continue
        pending.extend((item, (*parts, key)) for key, item in reversed(items))


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    plain = dict(pairs)
    if len(plain) == len(pairs):
        return plain
    repeating, seen = _Repeating(plain), set[str]()
    repeating.repeated = []
    for key, _ in pairs:
        if key in seen and key not in repeating.repeated:
            repeating.repeated.append(key)
        seen.add(key)
    return repeating


def _integer(digits: str) -> int | float:
    return int(digits) if len(digits) < _LONGEST_INTEGER else float(digits)


def _key_faults(value: dict[Any, Any], parts: tuple[Part, ...]) -> Iterator[Issue]:
    if isinstance(value, _Repeating):
        for key in filter(_is_text, value.repeated):
            yield Issue(pointer(*parts, key), f"the key {quoted(key)} is given more than once")
    if not all(map(_is_text, value)):
        yield Issue(pointer(*parts), "a key is not a text of whole Unicode characters")


def _leaf_faults(value: Any, parts: tuple[Part, ...]) -> Iterator[Issue]:
    if isinstance(value, float) and not math.isfinite(value):
        hint = "leave an open limit out, or write null"
        yield Issue(pointer(*parts), "NaN and infinities are not allowed", hint)
    elif isinstance(value, str) and not _is_text(value):
        yield Issue(pointer(*parts), "a text with half of a Unicode character (a lone surrogate)")
    elif value is not None and not isinstance(value, str | int | float):
        yield Issue(pointer(*parts), f"{type(value).__name__} is not a type of JSON")


def _is_text(value: Any) -> bool:
    if not isinstance(value, str):
        return False
    return value.isascii() or not any("\ud800" <= character <= "\udfff" for character in value)


def _too_deep() -> Issue:
    return Issue("", f"over the limit 'nesting': deeper than {MODEL_LIMITS.nesting} levels")
