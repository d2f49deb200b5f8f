"""Any damage to a problem is either harmless or a BadProblem that points at a real place."""

import json
from collections.abc import Callable, Iterator
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from schemas.errors import BadProblem
from schemas.reading import MAX_ISSUES, canonical, read_problem
from tests.support.problems import cart_pole, hop

words = st.sampled_from(
    ["q1", "q3", "t", "kind", "ode", "hermite_simpson", "linear", "constant", "points", "a b",
     "closed_form", "second_order", "residual", "radau", "dircol5i", "multiple_shooting", "random",
     "solution", "slack", "stance", "k", "d(y)", "dd(y)", "dddd(u)", "stance.final.d(tip)", "since",
     "1/0", "sin(", "m1", "final.q1", "effort", "[key]", "~/", "", "\ud800", "\u03c0"]
)  # fmt: skip
leaves = st.none() | st.booleans() | st.integers() | st.floats() | words | st.text(max_size=5)
values = st.recursive(
    leaves,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(words, inner, max_size=3),
    max_leaves=6,
)


def _places(value: Any, way: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    yield way
    if isinstance(value, dict | list):
        items = value.items() if isinstance(value, dict) else enumerate(value)
        for key, item in items:
            yield from _places(item, (*way, key))


def _at(document: Any, way: tuple[Any, ...]) -> Any:
    for part in way:
        document = document[part]
    return document


@st.composite
def damaged(draw: st.DrawFn, *sources: Callable[[], Any]) -> Any:
    sound = draw(st.sampled_from(sources or (cart_pole, hop)))
    document: Any = sound()
    for _ in range(draw(st.integers(1, 3))):
        way = draw(st.sampled_from(list(_places(document))))
        if not way:
            continue
        parent, key = _at(document, way[:-1]), way[-1]
        action = draw(st.sampled_from(["replace", "replace", "delete", "insert", "swap"]))
        if action == "delete":
            del parent[key]
        elif action == "insert" and isinstance(parent, dict):
            parent[draw(words)] = draw(values)
        elif action == "swap":
            parent[key] = _at(sound(), draw(st.sampled_from(list(_places(sound())))))
        else:
            parent[key] = draw(values)
    return document


def _resolves(document: Any, pointer: str) -> bool:
    """Whether the pointer leads to a place, or to one missing from an object that is there."""
    parts = [part.replace("~1", "/").replace("~0", "~") for part in pointer.split("/")[1:]]
    for index, part in enumerate(parts):
        if isinstance(document, list) and part.isdigit() and int(part) < len(document):
            document = document[int(part)]
        elif isinstance(document, dict) and part in document:
            document = document[part]
        else:
            return isinstance(document, dict) and index == len(parts) - 1
    return True


def _refusal(document: Any) -> BadProblem | None:
    """Why the document is refused; None where it is read, and then its canonical form is too."""
    try:
        problem = read_problem(document)
    except BadProblem as bad:
        return bad
    assert canonical(read_problem(canonical(problem))) == canonical(problem)
    return None


@given(damaged())
@settings(max_examples=400, deadline=None)
def test_damage_is_harmless_or_placed(document: Any) -> None:
    bad = _refusal(document)
    if bad is None:
        return
    assert 1 <= len(bad.issues) <= MAX_ISSUES
    for issue in bad.issues:
        assert _resolves(document, issue.pointer), issue
        assert issue.message
        assert str(issue).encode()


@given(st.data())
@settings(max_examples=200, deadline=None)
def test_damaged_text_is_read_or_refused(data: st.DataObject) -> None:
    text = json.dumps(cart_pole()).encode()
    start = data.draw(st.integers(0, len(text)))
    stop = data.draw(st.integers(start, min(len(text), start + 20)))
    patch = data.draw(st.binary(max_size=4) | st.sampled_from([b'"', b"}", b"]", b"NaN", b"1e999"]))
    bad = _refusal(text[:start] + patch + text[stop:])
    assert bad is None or bad.issues
