"""The pydantic field for an expression: checked when read, the user's text when written."""

from dataclasses import dataclass, field
from typing import Any, Self

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from schemas.expressions.errors import ExpressionError
from schemas.expressions.parser import parse
from schemas.expressions.tokens import MAX_CONSTANT, MAX_LENGTH
from schemas.expressions.tree import Tree


@dataclass(frozen=True, slots=True)
class Expression:
    """An expression: the user's ``text`` and the ``tree`` that it means. Equal by text."""

    text: str
    tree: Tree = field(compare=False, repr=False)

    @classmethod
    def read(cls, raw: Any) -> Self:
        """Check one raw JSON value: a text, or a number.

        Raises
        ------
        PydanticCustomError
            Of type ``expression``, with ``column`` and ``hint`` in its context.
        """
        if isinstance(raw, cls):
            return raw
        if isinstance(raw, bool) or not isinstance(raw, str | int | float):
            raise _error("expected an expression, a text or a number")
        if not isinstance(raw, str) and not abs(raw) <= MAX_CONSTANT:
            raise _error(f"expected a number of at most {MAX_CONSTANT:g} in size")
        text = raw if isinstance(raw, str) else repr(raw)
        try:
            return cls(text, parse(text))
        except ExpressionError as error:
            raise _error(error.message, error.column, error.hint) from None

    def __str__(self) -> str:
        return self.text

    @classmethod
    def __get_pydantic_core_schema__(cls, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(
            cls.read, serialization=core_schema.plain_serializer_function_ser_schema(str)
        )

    @classmethod
    def __get_pydantic_json_schema__(
        cls, _: CoreSchema, __: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        return {
            "type": ["string", "number"],
            "maxLength": MAX_LENGTH,
            "description": "Arithmetic and the usual functions over declared names.",
        }


def _error(message: str, column: int | None = None, hint: str = "") -> PydanticCustomError:
    context = {"message": message, "column": column, "hint": hint}
    return PydanticCustomError("expression", "{message}", context)
