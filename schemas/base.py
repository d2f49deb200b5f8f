"""The base of every model: frozen, unknown fields refused, no NaN and no infinity."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import BaseModel, ConfigDict, GetJsonSchemaHandler, StringConstraints
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema


class Strict(BaseModel):
    """A frozen model that refuses unknown fields, NaN and infinities."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Posted(Strict):
    """A model of what clients post: no conversion either, ``true`` is no number."""

    model_config = ConfigDict(strict=True)


Identifier = Annotated[str, StringConstraints(pattern=r"^[A-Za-z_][A-Za-z0-9_]{0,63}$")]
"""The name of a state, a control, a parameter, a phase: a letter, then letters, digits, _."""

Series = Annotated[
    str,
    StringConstraints(
        pattern=r"^(?:[A-Za-z_][A-Za-z0-9_]{0,63}\.){0,3}"
        r"(?:d{1,4}\([A-Za-z_][A-Za-z0-9_]{0,63}\)|[A-Za-z_][A-Za-z0-9_]{0,63})$"
    ),
]
"""What varies along a phase: a state, a control, or a derivative of one such as ``d(x)``."""

Label = Annotated[
    str, StringConstraints(min_length=1, max_length=200, pattern=r"^[^\x00-\x1f\x7f]*$")
]
"""Free text on one line, such as the name of a problem."""


@dataclass(frozen=True, slots=True)
class AlsoNamed:
    """In the published schema of a union: one more object, that stands for a member.

    It names something that the edge puts in its place (`schemas.inlining`) before a problem is
    read, so no model knows it.
    """

    properties: tuple[tuple[str, str], ...]
    """Field -> JSON Schema's type, or the one text that it may be, after ``=``."""
    description: str
    optional: tuple[str, ...] = ()

    def __get_pydantic_json_schema__(
        self, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        union = handler(core)
        fields: dict[str, JsonSchemaValue] = {
            name: {"const": kind[1:]} if kind.startswith("=") else {"type": kind}
            for name, kind in self.properties
        }
        named: JsonSchemaValue = {
            "type": "object",
            "description": self.description,
            "properties": fields,
            "required": [name for name in fields if name not in self.optional],
            "additionalProperties": False,
        }
        return {**union, "oneOf": [*union["oneOf"], named]}
