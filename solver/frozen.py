"""Values to compare by: equal where all that is in them is."""

from collections.abc import Hashable, Iterable, Mapping
from dataclasses import fields, is_dataclass

import numpy as np


def frozen(value: object) -> Hashable:
    """Something that equals another one's only where both are the same through and through.

    Numbers by their bits, arrays by their bytes, dataclasses by their fields; other objects of this
    engine by their attributes.

    Raises
    ------
    TypeError
        For what cannot be compared so.
    """
    if value is None or isinstance(value, bool | int | str):
        return type(value).__name__, value
    if isinstance(value, float):
        return "float", float(value).hex()
    if isinstance(value, np.ndarray | np.generic):
        return "array", value.dtype.str, value.shape, value.tobytes()
    return type(value), *(frozen(part) for part in _parts(value))


def _parts(value: object) -> Iterable[object]:
    if isinstance(value, tuple | list):
        return value
    if isinstance(value, Mapping):
        return value.items()
    if is_dataclass(value) and not isinstance(value, type):
        return [getattr(value, one.name) for one in fields(value)]
    if type(value).__module__.startswith("solver.") and hasattr(value, "__dict__"):
        return sorted(vars(value).items())
    raise TypeError(f"a {type(value).__name__} cannot be compared")
