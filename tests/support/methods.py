"""Every method of the language with every choice of its options, for tests that run them all."""

import itertools
from collections.abc import Mapping
from typing import Any, Literal, get_args, get_origin

from pydantic.fields import FieldInfo

from schemas.methods import METHODS, DirCol5i

NUMBERS: Mapping[str, tuple[int, ...]] = {"points": (2, 3), "degree": (6,), "steps": (1, 3)}
"""What tests try of options that are numbers; a new one stands here."""


def variants(*, second_order: bool = False) -> list[dict[str, Any]]:
    """Every method with all combinations of its options; ``segments`` is left to the test.

    Methods that need a second-order system are among them for those alone.
    """
    return [
        dict(zip(options, values, strict=True))
        for method in METHODS
        if second_order or method is not DirCol5i
        if (
            options := {
                name: _choices(name, field)
                for name, field in method.model_fields.items()
                if name != "segments"
            }
        )
        for values in itertools.product(*options.values())
    ]


def _choices(name: str, field: FieldInfo) -> tuple[Any, ...]:
    return get_args(field.annotation) if get_origin(field.annotation) is Literal else NUMBERS[name]


def label(method: dict[str, Any]) -> str:
    """A name for a test's parameter."""
    return "-".join(map(str, method.values()))
