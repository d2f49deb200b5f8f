"""The gallery: every problem is a JSON file that can be posted as it is."""

import json
from importlib.resources import files
from typing import Any


def names() -> list[str]:
    """The names of the examples, sorted."""
    entries = files(__name__).iterdir()
    return sorted(
        entry.name.removesuffix(".json") for entry in entries if entry.name.endswith(".json")
    )


def load(name: str) -> dict[str, Any]:
    """One example as JSON values.

    Raises
    ------
    KeyError
        If there is no example of that name.
    """
    if name not in names():
        raise KeyError(name)
    text = (files(__name__) / f"{name}.json").read_text(encoding="utf-8")
    return dict(json.loads(text))
