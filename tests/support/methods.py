"""Every method of the language with every choice of its options, for tests that run them all."""

import itertools
from typing import Any, Literal, get_args, get_origin

from schemas.methods import METHODS


def variants() -> list[dict[str, Any]]:
    """A method's fields of named choices, in all combinations; numbers keep their defaults."""
    return [
        dict(zip(choices, values, strict=True))
        for method in METHODS
        if (
            choices := {
                name: get_args(field.annotation)
                for name, field in method.model_fields.items()
                if get_origin(field.annotation) is Literal
            }
        )
        for values in itertools.product(*choices.values())
    ]


def label(method: dict[str, Any]) -> str:
    """A name for a test's parameter."""
    return "-".join(method.values())
