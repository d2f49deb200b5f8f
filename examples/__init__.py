"""The gallery: problems and simulations as JSON files that can be posted as they are."""

import json
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Any


def names() -> list[str]:
    """The names of the problems, sorted."""
    return _names(files(__name__))


def simulations() -> list[str]:
    """The names of the simulations, sorted; none is also that of a problem."""
    return _names(files(__name__) / "simulations")


def load(name: str) -> dict[str, Any]:
    """One example as JSON values.

    Raises
    ------
    KeyError
        If there is no example of that name.
    """
    folder = files(__name__)
    if name in simulations():
        folder = folder / "simulations"
    elif name not in names():
        raise KeyError(name)
    return dict(json.loads((folder / f"{name}.json").read_text(encoding="utf-8")))


def _names(folder: Traversable) -> list[str]:
    return sorted(
        entry.name.removesuffix(".json")
        for entry in folder.iterdir()
        if entry.name.endswith(".json")
    )
