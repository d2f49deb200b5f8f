"""The parser of server-sent events follows the standard's rules."""

import pytest

from footfall.errors import BadReply
from footfall.sse import Event, parse


def events(text: str) -> list[Event]:
    return list(parse(text.split("\n")))


def test_an_event_has_type_data_and_id() -> None:
    (event,) = events('id: 7-0\nevent: stage\ndata: {"type": "stage", "stage": "build"}\n\n')
    assert event == Event("stage", {"type": "stage", "stage": "build"}, "7-0")


def test_comments_and_unknown_fields_are_passed_over() -> None:
    assert events(': keep-alive\nretry: 2000\n\nfoo: bar\ndata:{"type":"x"}\n\n') == [
        Event("x", {"type": "x"})
    ]


def test_data_of_several_lines_is_one_document() -> None:
    assert events('data: {"type":\ndata: "x"}\n\n')[0].type == "x"


def test_the_id_stays_until_another_comes() -> None:
    found = events(
        'id: 1\ndata: {"type":"a"}\n\ndata: {"type":"b"}\n\nid: 3\ndata: {"type":"c"}\n\n'
    )
    assert [event.id for event in found] == ["1", "1", "3"]


def test_an_event_that_was_cut_off_is_not_told() -> None:
    assert events('data: {"type": "a"}\n\ndata: {"type": "b"}') == [Event("a", {"type": "a"})]


def test_only_the_end_of_a_job_is_terminal() -> None:
    assert Event("state", {"status": "succeeded", "terminal": True}).terminal
    assert not Event("state", {"status": "running", "terminal": False}).terminal
    assert not Event("mesh", {}).terminal


@pytest.mark.parametrize("data", ["{", "[1]", '{"no": "type"}', "7"])
def test_what_cannot_be_read_is_a_bad_reply(data: str) -> None:
    with pytest.raises(BadReply, match="cannot be read"):
        events(f"data: {data}\n\n")
