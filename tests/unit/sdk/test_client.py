"""The client against a service that misbehaves in known ways."""

import json
import time
from collections.abc import Callable, Iterator
from typing import Any

import httpx
import pytest

from footfall import errors
from footfall.client import Client
from footfall.transport import Retries, retry_after

JOB = {"id": "j", "name": "n", "status": "queued", "timings": {}, "links": {}}
DONE = JOB | {"status": "succeeded", "solution_status": "converged", "error": None}
Handler = Callable[[httpx.Request], httpx.Response]


@pytest.fixture(autouse=True)
def pauses(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    taken: list[float] = []
    monkeypatch.setattr(time, "sleep", taken.append)
    return taken


def client(handler: Handler, tries: int = 3) -> Client:
    return Client(
        "http://service", retries=Retries(tries=tries), transport=httpx.MockTransport(handler)
    )


def script(*steps: httpx.Response | Exception) -> tuple[Handler, list[httpx.Request]]:
    """A service that gives these answers in turn; and the requests it got."""
    seen: list[httpx.Request] = []
    answers = iter(steps)

    def handler(request: httpx.Request) -> httpx.Response:
        seen.append(request)
        answer = next(answers)
        if isinstance(answer, Exception):
            raise answer
        return answer

    return handler, seen


def problem(status: int, code: str, **headers: str) -> httpx.Response:
    document = {"type": f"/problems/{code}", "detail": f"it is {code}", "status": status}
    kind = {"Content-Type": "application/problem+json"}
    return httpx.Response(status, content=json.dumps(document), headers=kind | headers)


def stream(*parts: str) -> httpx.Response:
    return httpx.Response(200, text="".join(parts), headers={"Content-Type": "text/event-stream"})


def event(number: int, document: dict[str, Any]) -> str:
    return f"id: {number}\nevent: {document['type']}\ndata: {json.dumps(document)}\n\n"


END = {"type": "state", "status": "succeeded", "terminal": True}
STAGE = {"type": "stage", "stage": "solve"}


def test_a_lost_answer_never_makes_a_second_job() -> None:
    handler, seen = script(httpx.ReadError("gone"), httpx.Response(202, json=JOB))
    assert client(handler).submit({"name": "n"}).id == "j"
    keys = [request.headers["Idempotency-Key"] for request in seen]
    assert len(keys) == 2
    assert keys[0] == keys[1]


def test_two_submissions_have_two_keys() -> None:
    handler, seen = script(httpx.Response(202, json=JOB), httpx.Response(202, json=JOB))
    with client(handler) as service:
        service.submit({"name": "n"})
        service.submit({"name": "n"})
    assert seen[0].headers["Idempotency-Key"] != seen[1].headers["Idempotency-Key"]


def test_a_key_still_in_flight_is_waited_for() -> None:
    handler, seen = script(
        httpx.ReadTimeout("late"), problem(409, "conflict"), httpx.Response(202, json=JOB)
    )
    assert client(handler).submit({}).id == "j"
    assert len({request.headers["Idempotency-Key"] for request in seen}) == 1


@pytest.mark.parametrize(("status", "code"), [(429, "rate-limited"), (503, "queue-full")])
def test_retry_after_is_honoured(status: int, code: str, pauses: list[float]) -> None:
    refusal = problem(status, code, **{"Retry-After": "7"})
    handler, _ = script(refusal, httpx.Response(200, json=JOB))
    assert client(handler).job("j").status == "queued"
    assert pauses == [7.0]


def test_patience_ends(pauses: list[float]) -> None:
    handler, seen = script(*[problem(503, "queue-full")] * 4)
    with pytest.raises(errors.TryLater, match="queue-full"):
        client(handler).job("j")
    assert len(seen) == 4
    assert len(pauses) == 3


def test_a_bare_503_of_a_proxy_is_retried_too() -> None:
    handler, _ = script(httpx.Response(503, text="busy"), httpx.Response(200, json=JOB))
    assert client(handler).job("j").id == "j"


def test_what_retrying_cannot_mend_is_not_retried() -> None:
    handler, seen = script(problem(404, "unknown-job"))
    with pytest.raises(errors.UnknownJob):
        client(handler).job("j")
    assert len(seen) == 1


def test_a_dead_service_is_named() -> None:
    handler, _ = script(*[httpx.ConnectError("refused")] * 4)
    with pytest.raises(errors.ConnectionFailed, match="http://service"):
        client(handler).job("j")


def test_something_else_at_the_address_is_told() -> None:
    handler, _ = script(httpx.Response(200, text="<html>hello"))
    with pytest.raises(errors.BadReply, match="instead of JSON"):
        client(handler).job("j")


def test_validate_returns_the_issues() -> None:
    issues = {"type": "/problems/bad-problem", "errors": [{"pointer": "/x", "message": "bad"}]}
    kind = {"Content-Type": "application/problem+json"}
    handler, seen = script(
        httpx.Response(422, content=json.dumps(issues), headers=kind),
        httpx.Response(200, json={"valid": True}),
        httpx.Response(200, json={"valid": True, "warnings": ["/multistart: so"]}),
    )
    with client(handler) as service:
        assert [str(issue) for issue in service.validate({})] == ["/x: bad"]
        assert service.validate({}) == []
        assert service.check({}) == ([], ["/multistart: so"])
    assert seen[0].url.params["validate_only"] == "true"


def test_a_number_that_json_lacks_is_refused_here() -> None:
    handler, seen = script()
    with pytest.raises(errors.BadProblem, match="JSON"):
        client(handler).submit({"name": float("nan")})
    assert not seen


def test_a_broken_stream_is_taken_up_after_the_last_event() -> None:
    handler, seen = script(
        stream(event(1, STAGE), event(2, STAGE), 'id: 3\ndata: {"type": "cut'),
        httpx.ReadError("gone"),
        stream(event(3, STAGE), event(4, END)),
    )
    assert [found.id for found in client(handler).events("j")] == ["1", "2", "3", "4"]
    assert [request.headers.get("Last-Event-ID") for request in seen] == [None, "2", "2"]


def test_a_stream_that_never_gets_on_is_given_up() -> None:
    handler, seen = script(*[stream()] * 10)
    with pytest.raises(errors.BadReply, match="keeps ending"):
        list(client(handler, tries=2).events("j"))
    assert len(seen) == 3


def test_wait_polls_until_the_end(solved: dict[str, Any]) -> None:
    handler, seen = script(
        httpx.Response(200, json=JOB),
        httpx.Response(200, json=JOB),
        httpx.Response(200, json=DONE),
        httpx.Response(200, json=solved),
    )
    assert client(handler).wait("j").converged
    assert int(seen[1].url.params["wait"]) > 0


def test_wait_hands_on_every_event(solved: dict[str, Any]) -> None:
    handler, _ = script(
        stream(event(1, STAGE), event(2, END)),
        httpx.Response(200, json=DONE),
        httpx.Response(200, json=solved),
    )
    seen: list[str] = []
    client(handler).wait("j", on_event=lambda found: seen.append(found.type))
    assert seen == ["stage", "state"]


def test_wait_ends_in_time(monkeypatch: pytest.MonkeyPatch) -> None:
    clock: Iterator[float] = iter([0.0, 0.5, 1.5])
    monkeypatch.setattr(time, "monotonic", lambda: next(clock))
    handler, _ = script(*[httpx.Response(200, json=JOB)] * 3)
    with pytest.raises(errors.WaitTimeout, match="goes on"):
        client(handler).wait("j", timeout=1.0)


def test_a_failed_job_says_why() -> None:
    error = {"type": "engine-fault", "message": "it broke", "hint": "tell us"}
    handler, _ = script(httpx.Response(200, json=JOB | {"status": "failed", "error": error}))
    with pytest.raises(errors.JobFailed, match="it broke"):
        client(handler).wait("j")


def test_an_invalid_model_is_a_bad_problem() -> None:
    issue = {"pointer": "/phases/0", "message": "NaN at the guess", "hint": "", "column": None}
    error = {"type": "invalid-model", "message": "x", "hint": "", "issues": [issue]}
    handler, _ = script(httpx.Response(200, json=JOB | {"status": "failed", "error": error}))
    with pytest.raises(errors.BadProblem, match="/phases/0: NaN"):
        client(handler).wait("j")


def test_jobs_go_through_all_pages() -> None:
    handler, seen = script(
        httpx.Response(200, json={"jobs": [JOB, JOB], "next": "c"}),
        httpx.Response(200, json={"jobs": [JOB], "next": None}),
    )
    assert len(list(client(handler).jobs(status="queued"))) == 3
    assert dict(seen[1].url.params) == {"status": "queued", "cursor": "c"}


def test_a_delete_whose_answer_was_lost_is_done() -> None:
    handler, _ = script(httpx.ReadError("gone"), problem(404, "unknown-job"))
    client(handler).delete("j")


@pytest.mark.parametrize("url", ["http://service/", "http://service/v1", "http://service/v1/"])
def test_the_versioned_path_is_no_part_of_the_address(url: str) -> None:
    handler, seen = script(httpx.Response(200, json=JOB))
    Client(url, transport=httpx.MockTransport(handler)).job("j")
    assert str(seen[0].url) == "http://service/v1/jobs/j"


def test_the_key_is_sent() -> None:
    handler, seen = script(httpx.Response(200, json=JOB))
    Client("http://service", "secret", transport=httpx.MockTransport(handler)).job("j")
    assert seen[0].headers["Authorization"] == "Bearer secret"


def test_retry_after_reads_seconds_and_dates() -> None:
    assert retry_after("3") == 3.0
    assert retry_after("Thu, 01 Jan 2015 00:00:00 GMT") == 0.0
    assert retry_after("soon") is None
    assert retry_after(None) is None
