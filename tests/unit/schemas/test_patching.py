"""Values put into documents at JSON pointers."""

import pytest

from schemas.patching import NoPlace, replaced

DOCUMENT = {"a": [{"b": 1, "c/d": 2}, 3], "e~f": None}


def test_values_are_replaced_and_the_document_is_not() -> None:
    before = repr(DOCUMENT)
    made = replaced(DOCUMENT, {"/a/0/b": [1], "/a/0/c~1d": "x", "/a/1": 4, "/e~0f": {}})
    assert made == {"a": [{"b": [1], "c/d": "x"}, 4], "e~f": {}}
    assert list(made) == list(DOCUMENT)
    assert repr(DOCUMENT) == before


@pytest.mark.parametrize(
    ("place", "words"),
    [
        ("a", "begins with /"),
        ("", "begins with /"),
        ("/b", "no 'b'"),
        ("/a/2", "no place in a list of 2"),
        ("/a/-1", "no place"),
        ("/a/-", "no place"),
        ("/a/0000000000009", "no place"),
        ("/a/1/x", "below a plain value"),
        ("/e~0f/x", "below a plain value"),
    ],
)
def test_what_is_not_there_is_no_place(place: str, words: str) -> None:
    with pytest.raises(NoPlace) as caught:
        replaced(DOCUMENT, {place: 0})
    assert words in caught.value.message


def test_a_near_name_is_hinted_at() -> None:
    with pytest.raises(NoPlace) as caught:
        replaced({"segments": 1}, {"/segment": 2})
    assert caught.value.hint == "did you mean 'segments'?"
