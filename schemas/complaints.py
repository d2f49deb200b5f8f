"""What pydantic says about a document, in plain words and with JSON pointers.

A pydantic location holds union tags and markers beside keys and indices. Walking the published
JSON Schema along it tells them apart, and ends at the fields that were allowed there.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

from pydantic_core import ErrorDetails

from schemas.errors import Issue
from schemas.expressions.errors import quoted
from schemas.pointers import Part, pointer
from schemas.problem import Problem
from schemas.suggest import did_you_mean

Schema = dict[str, Any]
Writer = Callable[[ErrorDetails, list[Part], Schema], Issue]

_PLAIN = {
    "model_type": "expected an object, {...}",
    "model_attributes_type": "expected an object, {...}",
    "dict_type": "expected an object, {...}",
    "list_type": "expected a list, [...]",
    "string_type": "expected a text",
    "int_type": "expected a whole number",
    "int_from_float": "expected a whole number",
    "int_parsing": "expected a whole number",
    "float_type": "expected a number",
    "float_parsing": "expected a number",
}


def issue_of(error: ErrorDetails) -> Issue:
    """One pydantic error as an issue."""
    parts, schema = _locate(error)
    write = _WRITERS.get(error["type"], _other)
    return write(error, parts, schema)


def _other(error: ErrorDetails, parts: list[Part], _: Schema) -> Issue:
    context = error.get("ctx", {})
    if "at" in context:  # a side of a pair
        parts = [*parts, context["at"]]
    message = _PLAIN.get(error["type"]) or _plain(error["msg"])
    return Issue(pointer(*parts), message, context.get("hint", ""), context.get("column"))


def _plain(message: str) -> str:
    comparison = message.startswith(("Input should be greater", "Input should be less"))
    return message.replace("Input should be", "expected a number" if comparison else "expected")


def _missing(_: ErrorDetails, parts: list[Part], __: Schema) -> Issue:
    return Issue(pointer(*parts), f"the field '{parts[-1]}' is missing")


def _unknown(_: ErrorDetails, parts: list[Part], schema: Schema) -> Issue:
    word, fields = str(parts[-1]), list(schema.get("properties", ()))
    hint = did_you_mean(word, fields) or "the fields here are " + ", ".join(fields)
    return Issue(pointer(*parts), f"unknown field {quoted(word)}", hint)


def _kind(error: ErrorDetails, parts: list[Part], schema: Schema) -> Issue:
    options = list(schema.get("discriminator", {}).get("mapping", {}))
    return _choice(error["input"].get("kind"), [*parts, "kind"], options)


def _literal(error: ErrorDetails, parts: list[Part], schema: Schema) -> Issue:
    options = schema.get("enum") or [schema.get("const")]
    return _choice(error["input"], parts, [str(option) for option in options])


def _choice(given: Any, parts: list[Part], options: list[str]) -> Issue:
    known = ", ".join(f"'{option}'" for option in options)
    if given is None:
        return Issue(
            pointer(*parts), f"the field '{parts[-1]}' is missing", f"it is one of {known}"
        )
    if not isinstance(given, str):
        return Issue(pointer(*parts), f"expected one of {known}")
    message = f"{quoted(given)} is none of {known}" if len(options) > 1 else f"expected {known}"
    return Issue(pointer(*parts), message, did_you_mean(given, options))


def _pattern(error: ErrorDetails, parts: list[Part], _: Schema) -> Issue:
    if not error["ctx"]["pattern"].startswith("^[A-Za-z_]"):
        return Issue(pointer(*parts), "expected one line of text, without control characters")
    hint = "a letter or _, then letters, digits and _, 64 at the most"
    return Issue(pointer(*parts), f"{quoted(error['input'])} is not a name", hint)


def _too_long(error: ErrorDetails, parts: list[Part], _: Schema) -> Issue:
    given, most = error["ctx"]["actual_length"], error["ctx"]["max_length"]
    message = f"over the limit of '{parts[-1]}': {given}, at most {most} are allowed"
    return Issue(pointer(*parts), message)


_WRITERS: dict[str, Writer] = {
    "missing": _missing,
    "extra_forbidden": _unknown,
    "union_tag_invalid": _kind,
    "union_tag_not_found": _kind,
    "literal_error": _literal,
    "string_pattern_mismatch": _pattern,
    "too_long": _too_long,
}


@cache
def _published() -> Schema:
    return Problem.model_json_schema()


def _locate(error: ErrorDetails) -> tuple[list[Part], Schema]:
    """The keys and indices of a location, and the schema of the last known object on the way."""
    marked = error["type"] != "extra_forbidden"  # there '[key]' is what the user wrote
    parts: list[Part] = []
    schema = _resolve(_published())
    for part in error["loc"]:
        kinds = schema.get("discriminator", {}).get("mapping", {})
        if part in kinds:
            schema = _resolve({"$ref": kinds[part]})
            continue
        if part == "[key]" and marked:
            continue
        parts.append(part)
        schema = _resolve(_below(schema, part)) or schema
    return parts, schema


def _below(schema: Schema, part: Part) -> Schema:
    if isinstance(part, int):
        return schema.get("items", {})  # type: ignore[no-any-return]
    by_pattern = list(schema.get("patternProperties", {}).values())
    return schema.get("properties", {}).get(part) or (by_pattern[0] if by_pattern else {})


def _resolve(schema: Schema) -> Schema:
    """Follow references, and through ``anyOf`` to whatever is not null."""
    while True:
        if "$ref" in schema:
            schema = _published()["$defs"][schema["$ref"].rsplit("/", 1)[1]]
        elif "anyOf" in schema and any(option.get("type") == "null" for option in schema["anyOf"]):
            schema = next(option for option in schema["anyOf"] if option.get("type") != "null")
        else:
            return schema
