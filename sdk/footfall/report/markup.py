"""HTML and SVG as values: everything that is not markup already is escaped."""

from html import escape
from importlib.resources import files


class Markup(str):
    """Text that may go into a page as it is. Only this package makes it."""

    __slots__ = ()


Child = str | int | float | None


def el(tag: str, /, *children: Child, **attributes: Child) -> Markup:
    """An element. Text is escaped, None is left out.

    An underscore in an attribute's name is a hyphen, at its end it is dropped: ``class_``,
    ``data_series``.
    """
    pairs = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{escape(str(value))}"'
        for key, value in attributes.items()
        if value is not None
    )
    return Markup(f"<{tag}{pairs}>{join(*children)}</{tag}>")


def void(tag: str, /, **attributes: Child) -> Markup:
    """An element of HTML that has no end tag."""
    return Markup(el(tag, **attributes).removesuffix(f"</{tag}>"))


def join(*children: Child) -> Markup:
    """One after the other, escaped where they are not markup."""
    return Markup("".join(_one(child) for child in children if child is not None))


def asset(name: str) -> str:
    """A text file of this package."""
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


def _one(child: Child) -> str:
    return child if isinstance(child, Markup) else escape(str(child))
