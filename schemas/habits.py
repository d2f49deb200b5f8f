"""What people write out of habit, and how this language says it."""

from collections.abc import Iterable
from itertools import product

from schemas.expressions import derivative

_RATES: tuple[tuple[str, ...], ...] = (
    ("d{}", "{}d", "{}p", "{}dot", "{}_dot", "d{}dt", "d{}_dt"),
    ("dd{}", "d2{}", "{}dd", "{}pp", "{}ddot", "{}_ddot", "d2{}dt2"),
    ("ddd{}", "{}ddd", "{}dddot", "{}_dddot", "{}_jerk"),
)
"""Names for the first, second and third derivative of a name, in other languages."""


def as_rate(word: str, names: Iterable[str]) -> str:
    """``write d(q)`` for ``qdot`` and the like, where ``q`` is one of ``names``; else nothing."""
    for name, (order, habits) in product(names, enumerate(_RATES, 1)):
        if any(habit.format(name) == word for habit in habits):
            return f"write {derivative(name, order)}"
    return ""
