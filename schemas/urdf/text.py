"""The pydantic field for a URDF text: read when it comes in, the user's text when written."""

from dataclasses import dataclass, field
from typing import Any, Self

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from schemas.limits import MODEL_LIMITS
from schemas.urdf.reading import read_robot
from schemas.urdf.robot import Robot
from schemas.urdf.xml import UrdfError


@dataclass(frozen=True, slots=True)
class UrdfText:
    """A URDF: the user's ``text`` and the ``robot`` that it describes. Equal by text."""

    text: str
    robot: Robot = field(compare=False, repr=False)

    @classmethod
    def read(cls, raw: Any) -> Self:
        """Read one raw JSON value.

        Raises
        ------
        PydanticCustomError
            Of type ``urdf``, with ``hint`` in its context; the message names the line.
        """
        if isinstance(raw, cls):
            return raw
        if not isinstance(raw, str):
            raise PydanticCustomError("urdf", "expected the text of a URDF")
        try:
            return cls(raw, read_robot(raw))
        except UrdfError as error:
            context = {"message": error.message, "hint": error.hint}
            raise PydanticCustomError("urdf", "{message}", context) from None

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
            "type": "string",
            "maxLength": MODEL_LIMITS.urdf_characters,
            "description": "URDF: links and joints. Meshes and other files are not read.",
        }
