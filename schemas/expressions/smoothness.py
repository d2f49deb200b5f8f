"""Notes on what a gradient-based solver does not like in an expression."""

from collections.abc import Set

from schemas.expressions.tree import Call, Tree, walk

_NOTES = {
    "abs": "not smooth where its argument is 0",
    "sign": "not continuous where its argument is 0",
    **dict.fromkeys(["min", "max"], "not smooth where its arguments are equal"),
    **dict.fromkeys(["sqrt", "hypot"], "without a derivative where it is 0"),
}


def warnings_in(tree: Tree, treated: Set[str] = frozenset()) -> list[str]:
    """One note for each non-smooth function that the tree uses, in order of appearance.

    Functions that are ``treated`` have none.
    """
    used = dict.fromkeys(node.function for node in walk(tree) if isinstance(node, Call))
    return [f"{name} is {_NOTES[name]}" for name in used if name in _NOTES and name not in treated]
