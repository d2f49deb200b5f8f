"""Values in a problem: a number, a constant expression, or a pair of bounds.

Both are plain dataclasses with their own pydantic validators, so an error points at the place
in the user's JSON and never at a branch of a union.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from schemas.expressions import Expression
from schemas.expressions.tokens import MAX_CONSTANT

_SCALAR_SCHEMA: JsonSchemaValue = {
    "anyOf": [{"type": "number"}, {"type": "string", "maxLength": 4000}],
    "description": "A number, or a constant expression over the parameters, such as 'pi/2'.",
}
_LIMIT_SCHEMA: JsonSchemaValue = {"anyOf": [*_SCALAR_SCHEMA["anyOf"], {"type": "null"}]}


@dataclass(frozen=True, slots=True)
class Scalar:
    """A number, or a constant expression."""

    source: float | Expression

    @classmethod
    def read(cls, raw: Any) -> Self:
        """Check one raw JSON value."""
        if isinstance(raw, cls):
            return raw
        if isinstance(raw, str):
            return cls(Expression.read(raw))
        if isinstance(raw, bool) or not isinstance(raw, int | float):
            raise PydanticCustomError("scalar", "expected a number or a constant expression")
        if not abs(raw) <= MAX_CONSTANT:
            raise PydanticCustomError(
                "scalar",
                "expected a number of at most {most} in size",
                {"most": f"{MAX_CONSTANT:g}"},
            )
        return cls(float(raw))

    def dump(self) -> float | str:
        """The JSON value that was read."""
        return self.source.text if isinstance(self.source, Expression) else self.source

    @classmethod
    def __get_pydantic_core_schema__(cls, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(
            cls.read, serialization=core_schema.plain_serializer_function_ser_schema(cls.dump)
        )

    @classmethod
    def __get_pydantic_json_schema__(
        cls, _: CoreSchema, __: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        return _SCALAR_SCHEMA


@dataclass(frozen=True, slots=True)
class Bound:
    """A fixed value (``lower is upper``), or a pair of limits, each of them perhaps open."""

    lower: Scalar | None
    upper: Scalar | None

    @property
    def fixed(self) -> bool:
        """Whether one value was given, not a pair."""
        return self.lower is not None and self.lower is self.upper

    @classmethod
    def read(cls, raw: Any) -> Self:
        """Check one raw JSON value: a scalar, or ``[lower, upper]`` with null for open."""
        if isinstance(raw, cls):
            return raw
        if raw is None or isinstance(raw, dict | bool):
            raise PydanticCustomError(
                "bound",
                "expected a number, a constant expression, or a pair [lower, upper]",
                {"hint": "null opens one side of a pair: [0, null]"},
            )
        if not isinstance(raw, list | tuple):
            value = Scalar.read(raw)
            return cls(value, value)
        if len(raw) != 2:
            raise PydanticCustomError(
                "bound",
                "expected a pair [lower, upper], got a list of {count}",
                {"count": len(raw)},
            )
        return cls(_side(raw, 0), _side(raw, 1))

    def dump(self) -> float | str | list[float | str | None] | None:
        """The JSON value that was read."""
        if self.fixed and self.lower is not None:
            return self.lower.dump()
        return [None if side is None else side.dump() for side in (self.lower, self.upper)]

    @classmethod
    def __get_pydantic_core_schema__(cls, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(
            cls.read, serialization=core_schema.plain_serializer_function_ser_schema(cls.dump)
        )

    @classmethod
    def __get_pydantic_json_schema__(
        cls, _: CoreSchema, __: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        return {
            "anyOf": [
                *_SCALAR_SCHEMA["anyOf"],
                {"type": "array", "items": _LIMIT_SCHEMA, "minItems": 2, "maxItems": 2},
            ],
            "description": "A number or expression fixes; [lower, upper] bounds, null is open.",
        }


def _side(pair: Sequence[Any], index: int) -> Scalar | None:
    try:
        return None if pair[index] is None else Scalar.read(pair[index])
    except PydanticCustomError as error:  # say which side it is
        context = {**(error.context or {}), "at": index}
        raise PydanticCustomError(error.type, error.message_template, context) from None
