"""Reading XML that nobody vouches for: elements and attributes, and nothing else that XML can do.

Expat does the reading. A document type is refused as soon as it opens, so there are no entities,
no expansion and nothing to fetch; depth and number of elements are counted while they come in, so
that the rest of an oversized text is never looked at.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NoReturn
from xml.parsers import expat

from schemas.expressions.errors import quoted
from schemas.limits import MODEL_LIMITS

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_LARGEST = 1e100


class UrdfError(ValueError):
    """Why a text cannot be taken: the reason, with the line where there is one, and the mend."""

    def __init__(self, message: str, hint: str = "", line: int | None = None) -> None:
        super().__init__(message)
        self.message = message if line is None else f"line {line}: {message}"
        self.hint = hint


@dataclass(slots=True)
class Element:
    """An element with its attributes and its children, in the order of the text."""

    tag: str
    attributes: Mapping[str, str]
    line: int
    children: list["Element"] = field(default_factory=list)

    def all(self, tag: str) -> list["Element"]:
        """The children of one tag."""
        return [child for child in self.children if child.tag == tag]

    def only(self, tag: str) -> "Element | None":
        """The child of a tag. Raises `UrdfError` where there are several."""
        found = self.all(tag)
        if len(found) > 1:
            found[1].refuse(f"a second <{tag}> in <{self.tag}>", "keep one of them")
        return found[0] if found else None

    def text(self, name: str) -> str:
        """An attribute that must be there. Raises `UrdfError` where it is not."""
        value = self.attributes.get(name, "").strip()
        if not value:
            self.refuse(f"<{self.tag}> has no '{name}'", f'write <{self.tag} {name}="...">')
        return value

    def numbers(self, name: str, count: int, default: str = "") -> tuple[float, ...]:
        """``count`` numbers of an attribute. Raises `UrdfError` where they are none."""
        words = self.attributes.get(name, default).split()
        if len(words) != count:
            given = f"{len(words)} numbers" if words else "nothing"
            self.refuse(f"'{name}' of <{self.tag}> needs {count} numbers, not {given}")
        return tuple(self._number(name, word) for word in words)

    def number(self, name: str, default: str = "") -> float:
        """One number of an attribute. Raises `UrdfError` where it is none."""
        return self.numbers(name, 1, default)[0]

    def _number(self, name: str, word: str) -> float:
        if not _NUMBER.fullmatch(word) or not abs(float(word)) <= _LARGEST:
            most = f"plain decimals, at most {_LARGEST:g} in size"
            self.refuse(f"'{name}' of <{self.tag}>: {quoted(word)} is no number", most)
        return float(word)

    def refuse(self, message: str, hint: str = "") -> NoReturn:
        """Raise an `UrdfError` at this element's line."""
        raise UrdfError(message, hint, self.line)


def read_xml(text: str) -> Element:
    """The root element of a text.

    Raises
    ------
    UrdfError
        With line, reason and mend: for what is not well-formed, for document types and entities,
        and for texts over the limits.
    """
    limit = MODEL_LIMITS.urdf_characters
    if len(text) > limit:
        raise UrdfError(f"over the limit: {len(text)} characters, at most {limit}", _SMALLER)
    if not text.strip():
        raise UrdfError("the text is empty", 'write <robot name="...">...</robot>')
    return _Reader().read(text)


_SMALLER = "a robot needs links and joints alone; leave out what only draws it"


class _Reader:
    """Builds elements out of expat's events, counting them."""

    def __init__(self) -> None:
        self._open: list[Element] = []
        self._root: Element | None = None
        self._count = 0
        self._parser = expat.ParserCreate("utf-8")  # the text is ours: no word of it about that
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.StartDoctypeDeclHandler = self._doctype
        self._parser.EntityDeclHandler = self._doctype

    def read(self, text: str) -> Element:
        try:
            self._parser.Parse(text.encode("utf-8", "replace"), True)
        except expat.ExpatError as error:
            reason = expat.ErrorString(error.code)
            mend = "send URDF as one well-formed XML text, xacro expanded"
            raise UrdfError(f"not XML: {reason}", mend, error.lineno) from None
        assert self._root is not None  # noqa: S101  expat refuses a text without elements
        return self._root

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        line = self._parser.CurrentLineNumber
        self._count += 1
        if self._count > MODEL_LIMITS.urdf_elements:
            most = MODEL_LIMITS.urdf_elements
            raise UrdfError(f"over the limit: more than {most} elements", _SMALLER, line)
        if len(self._open) >= MODEL_LIMITS.urdf_depth:
            most = MODEL_LIMITS.urdf_depth
            mend = "links and joints stand beside each other in <robot>, not in each other"
            raise UrdfError(f"elements nested over {most} deep", mend, line)
        element = Element(tag, attributes, line)
        if self._open:
            self._open[-1].children.append(element)
        else:
            self._root = element
        self._open.append(element)

    def _end(self, _: str) -> None:
        self._open.pop()

    def _doctype(self, *_: object) -> None:
        line = self._parser.CurrentLineNumber
        mend = "take it away: URDF needs none"
        raise UrdfError("document types and entities are refused", mend, line)
