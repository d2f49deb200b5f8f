"""What pydantic says about a document, in plain words and with JSON pointers.

A pydantic location holds union tags and markers beside keys and indices. Walking the published
JSON Schema along it tells them apart, and ends at the fields that were allowed there.
"""

import json
import re
from collections.abc import Callable
from functools import cache
from typing import Any

from pydantic_core import ErrorDetails

from schemas.base import Posted
from schemas.errors import Issue
from schemas.expressions.errors import quoted
from schemas.phases import Phase
from schemas.pointers import Part, pointer
from schemas.problem import Limits, Problem, Refinement, SolverSettings
from schemas.suggest import did_you_mean
from schemas.systems import SYSTEMS

Schema = dict[str, Any]
Writer = Callable[[ErrorDetails, list[Part], Schema], Issue]

_PLAIN = {
    "string_type": "expected a text",
    "int_type": "expected a whole number",
    "int_from_float": "expected a whole number",
    "int_parsing": "expected a whole number",
    "float_type": "expected a number",
    "float_parsing": "expected a number",
    "bool_type": "expected true or false",
    "bool_parsing": "expected true or false",
}
_GIVEN: dict[type, str] = {
    dict: "an object",
    list: "a list",
    str: "a text",
    bool: "true or false",
    int: "a number",
    float: "a number",
    type(None): "null",
}
_ABS = 'write "abs": "slack", "abs": {"tanh": 0.01} or "abs": {"sqrt": 0.001}'
_FEW = 4  # fields that are named beside another hint
_SHOWN = 60  # characters of a value that a hint repeats
_MAXIMIZE = 'to maximize, minimize the negative: {"minimize": "-(...)"}'
_MEANT = {
    **dict.fromkeys(("hinge", "pin", "rotational", "continuous"), "revolute"),
    **dict.fromkeys(("slider", "linear", "translational"), "prismatic"),
    **dict.fromkeys(("fixed", "rigid", "weld"), "welded"),
    **dict.fromkeys(("free", "planar", "base"), "floating"),
    **dict.fromkeys(("stick", "stuck", "static"), "sticking"),
}
"""What parts of mechanisms are called elsewhere."""
_PLANE = "write x and y, such as [0, -9.81]"
_INLINED = ("from_job", "library")
_EDGE = (
    "a service and the footfall command put in what it names before the problem is read; "
    "here, write it out"
)
_FIELDS = {
    system.model_fields["kind"].annotation.__args__[0]: system.model_fields  # type: ignore[union-attr]
    for system in SYSTEMS
}
_HOMES: tuple[tuple[type[Posted], str], ...] = (
    *((system, "a phase's 'system'") for system in SYSTEMS),
    (Phase, "a phase, an entry of 'phases'"),
    (Problem, "the problem itself"),
    (Refinement, "'refinement'"),
    (SolverSettings, "'solver'"),
    (Limits, "'limits'"),
)


def issue_of(error: ErrorDetails, document: type[Posted] = Problem) -> Issue:
    """One pydantic error, of a kind of document, as an issue."""
    parts, schema = _locate(error, document)
    write = _WRITERS.get(error["type"], _other)
    return write(error, parts, schema)


def _other(error: ErrorDetails, parts: list[Part], _: Schema) -> Issue:
    context = error.get("ctx", {})
    if "at" in context:  # a side of a pair, or the way to a part
        inner = context["at"]
        parts = [*parts, *(inner if isinstance(inner, tuple) else (inner,))]
    message = _PLAIN.get(error["type"]) or _plain(error["msg"])
    return Issue(pointer(*parts), message, context.get("hint", ""), context.get("column"))


def _plain(message: str) -> str:
    comparison = message.startswith(("Input should be greater", "Input should be less"))
    return message.replace("Input should be", "expected a number" if comparison else "expected")


def _missing(_: ErrorDetails, parts: list[Part], schema: Schema) -> Issue:
    hint = f'write "{parts[-1]}": "{schema["const"]}"' if "const" in schema else ""
    hint = _ABS if parts[-2:] == ["nonsmooth", "abs"] else hint
    return Issue(pointer(*parts), f"the field '{parts[-1]}' is missing", hint)


def _unknown(_: ErrorDetails, parts: list[Part], schema: Schema) -> Issue:
    word, fields = str(parts[-1]), list(schema.get("properties", ()))
    known = "the fields here are " + ", ".join(fields)
    kind = schema.get("properties", {}).get("kind", {}).get("const")
    if word == "maximize" and "minimize" in fields:
        hint = _MAXIMIZE
    elif kind in _FIELDS and any(word in others for others in _FIELDS.values()):
        owners = " or ".join(name for name, others in _FIELDS.items() if word in others)
        hint = f"that is of the kind {owners}; the fields of {kind} are " + ", ".join(fields)
    else:
        hint = _home(word) or did_you_mean(word, fields)
        hint = f"{known}; {hint}" if hint and 1 < len(fields) <= _FEW else hint or known
    return Issue(pointer(*parts), f"unknown field {quoted(word)}", hint)


def _home(word: str) -> str:
    """Where a field that is unknown here is known."""
    home = next((where for model, where in _HOMES if word in model.model_fields), "")
    return f"it belongs into {home}" if home else ""


def _object(error: ErrorDetails, parts: list[Part], schema: Schema) -> Issue:
    message = f"expected an object, {{...}}, got {_given(error)}"
    return Issue(pointer(*parts), message, _as_object(error["input"], schema))


def _as_object(given: Any, schema: Schema) -> str:
    """How what was given may have been meant."""
    kinds = schema.get("discriminator", {}).get("mapping", {})
    if kinds:
        kind = given if isinstance(given, str) and given in kinds else next(iter(kinds))
        return f'write {{"kind": "{kind}"}}; the kinds are {", ".join(kinds)}'
    fields = list(schema.get("properties", ()))
    needed = schema.get("required", ()) if isinstance(given, list) else fields
    if len(needed) == 1:
        return f'write {{"{needed[0]}": {_again(given)}}}'
    return "the fields are " + ", ".join(fields) if fields else 'each under its name: {"x": ...}'


def _again(given: Any) -> str:
    """What was given, as JSON; dots where that is long."""
    text = json.dumps(given, default=str)
    return text if len(text) <= _SHOWN else "..."


def _list(error: ErrorDetails, parts: list[Part], schema: Schema) -> Issue:
    message = f"expected a list, [...], got {_given(error)}"
    hint = "put it in brackets; commas stand between the items"
    if _is_vector(schema):
        hint = _PLANE
    elif isinstance(error["input"], str | int | float):
        hint = f"write [{_again(error['input'])}]"
    return Issue(pointer(*parts), message, hint)


def _given(error: ErrorDetails) -> str:
    return _GIVEN.get(type(error["input"]), "something else")


def _kind(error: ErrorDetails, parts: list[Part], schema: Schema) -> Issue:
    options = list(schema.get("discriminator", {}).get("mapping", {}))
    for word in _INLINED:
        if word == error["input"].get("kind") == "from_job":
            hint = 'write {"from_job": "..."} with the id of the job, without a kind'
            return Issue(pointer(*parts, "kind"), "a job is no kind of guess", hint)
        if word in (error["input"].get("kind"), *error["input"]):
            return Issue(pointer(*parts), f"{quoted(word)} is a name that is not known here", _EDGE)
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
    if parts[-2:] == ["nonsmooth", "abs"]:
        return Issue(pointer(*parts), f"{quoted(given)} is no treatment of abs", _ABS)
    message = f"{quoted(given)} is none of {known}" if len(options) > 1 else f"expected {known}"
    meant = _MEANT.get(given)
    hint = f"write '{meant}'" if meant in options else did_you_mean(given, options)
    return Issue(pointer(*parts), message, hint)


def _pattern(error: ErrorDetails, parts: list[Part], _: Schema) -> Issue:
    pattern = error["ctx"]["pattern"]
    if "[A-Za-z_]" not in pattern:
        return Issue(pointer(*parts), "expected one line of text, without control characters")
    hint = "a letter or _, then letters, digits and _, 64 at the most"
    if "(" in str(error["input"]) and "d{1,4}" in pattern:
        hint = "derivatives are those of one name, d(x), dd(x), ddd(x) and dddd(x)"
    elif rate := re.fullmatch(r"d+\((\w+)\)", str(error["input"])):
        hint = f"write the name alone, {rate[1]}"
    return Issue(pointer(*parts), f"{quoted(error['input'])} is not a name", hint)


def _is_vector(schema: Schema) -> bool:
    """Whether x and y are wanted."""
    pair = schema.get("minItems") == schema.get("maxItems") == 2
    return pair and "number" in schema.get("items", {}).get("type", ())


def _too_short(error: ErrorDetails, parts: list[Part], schema: Schema) -> Issue:
    if not _is_vector(schema):
        least, count = error["ctx"]["min_length"], error["ctx"]["actual_length"]
        entries = "one entry" if least == 1 else f"{least} entries"
        got = "none" if count == 0 else str(count)
        return Issue(pointer(*parts), f"expected {entries} or more, got {got}")
    given = error["ctx"]["actual_length"]
    return Issue(pointer(*parts), f"expected x and y, got a list of {given}", _PLANE)


def _too_long(error: ErrorDetails, parts: list[Part], schema: Schema) -> Issue:
    given, most = error["ctx"]["actual_length"], error["ctx"]["max_length"]
    if _is_vector(schema):
        return Issue(pointer(*parts), f"expected x and y, got a list of {given}", _PLANE)
    message = f"over the limit of '{parts[-1]}': {given}, at most {most} are allowed"
    return Issue(pointer(*parts), message)


_WRITERS: dict[str, Writer] = {
    "model_type": _object,
    "model_attributes_type": _object,
    "dict_type": _object,
    "list_type": _list,
    "missing": _missing,
    "extra_forbidden": _unknown,
    "union_tag_invalid": _kind,
    "union_tag_not_found": _kind,
    "literal_error": _literal,
    "string_pattern_mismatch": _pattern,
    "too_long": _too_long,
    "too_short": _too_short,
}


@cache
def _published(document: type[Posted]) -> Schema:
    return document.model_json_schema()


def _locate(error: ErrorDetails, document: type[Posted]) -> tuple[list[Part], Schema]:
    """The keys and indices of a location, and the schema of the last known object on the way."""
    marked = error["type"] != "extra_forbidden"  # there '[key]' is what the user wrote
    parts: list[Part] = []
    published = _published(document)
    schema = _resolve(published, published)
    for part in error["loc"]:
        tagged = _tags(schema)
        if part in tagged:
            schema = _resolve(tagged[part], published)
            continue
        if part == "[key]" and marked:
            continue
        parts.append(part)
        schema = _resolve(_below(schema, part), published) or schema
    return parts, schema


def _tags(schema: Schema) -> dict[Part, Schema]:
    """What stands for the members of a union in a location, each with its schema."""
    if "discriminator" in schema:
        return {kind: {"$ref": ref} for kind, ref in schema["discriminator"]["mapping"].items()}
    members = schema.get("oneOf", [])
    return {one.get("const") or one["$ref"].rsplit("/", 1)[1]: one for one in members}


def _below(schema: Schema, part: Part) -> Schema:
    if isinstance(part, int):
        return schema.get("items", {})  # type: ignore[no-any-return]
    by_pattern = list(schema.get("patternProperties", {}).values())
    return schema.get("properties", {}).get(part) or (by_pattern[0] if by_pattern else {})


def _resolve(schema: Schema, published: Schema) -> Schema:
    """Follow references, and through ``anyOf`` to whatever is not null."""
    while True:
        if "$ref" in schema:
            schema = published["$defs"][schema["$ref"].rsplit("/", 1)[1]]
        elif "anyOf" in schema and any(option.get("type") == "null" for option in schema["anyOf"]):
            schema = next(option for option in schema["anyOf"] if option.get("type") != "null")
        else:
            return schema
