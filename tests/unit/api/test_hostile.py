"""Bad input: each a clear answer, never a 500, and the service alive afterwards."""

import json
from collections.abc import Iterator
from typing import Any

import orjson
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import examples
from tests.support.asgi import AppClient

JSON = {"Content-Type": "application/json"}


@pytest.fixture(autouse=True)
def alive_afterwards(client: AppClient) -> Iterator[None]:
    yield
    assert client.get("/livez").status_code == 200
    assert client.post("/v1/jobs", json=examples.load("cart_pole")).status_code == 202


def with_expression(text: str) -> dict[str, Any]:
    problem = examples.load("cart_pole")
    problem["phases"][0]["integrals"]["effort"] = text
    return problem


BOMBS = {
    "tower": "9**9**9",
    "caret tower": "9^9^9^9",
    "parentheses": "(" * 100_000 + "u" + ")" * 100_000,
    "short parentheses": "(" * 1900 + "u" + ")" * 1900,
    "minus signs": "-" * 3900 + "u",
    "long sum": "+".join(["u"] * 1990),
    "attribute": "u.__class__.__mro__",
    "import": "__import__('os').system('true')",
    "lambda": "(lambda: u)()",
    "subscript": "[u][0]",
    "huge constant": "1e999*u",
    "many digits": "9" * 3900,
    "string": "'u' * 10**9",
    "not ASCII": "\u0075\u0308 + \U0001d62e",
    "null byte": "u\x00",
    "surrogate": "u + \ud800",
    "division by zero": "u / 0",
    "star-arguments": "min(*[u])",
    "walrus": "(x := u)",
    "empty": "",
}


@pytest.mark.parametrize("text", BOMBS.values(), ids=BOMBS.keys())
def test_expression_bombs(client: AppClient, text: str) -> None:
    body = json.dumps(with_expression(text)).encode()
    reply = client.post("/v1/jobs", content=body, headers=JSON)
    assert reply.status_code == 422
    error = reply.json()["errors"][0]
    if text != BOMBS["surrogate"]:
        assert error["pointer"] == "/phases/0/integrals/effort"
    assert error["message"]
    assert len(reply.content) < 10_000


BODIES = {
    "nothing": b"",
    "half": b'{"name": ',
    "scalar": b"3",
    "list": b"[]",
    "null": b"null",
    "not UTF-8": b'{"name": "\xff\xfe"}',
    "UTF-16": '{"name": "x"}'.encode("utf-16"),
    "NaN": b'{"name": "x", "phases": NaN}',
    "infinity": b'{"limits": {"seconds": 1e999}}',
    "duplicate key": b'{"name": "x", "name": "y"}',
    "deep lists": b"[" * 100_000,
    "deep objects": b'{"a":' * 50_000 + b"1" + b"}" * 50_000,
    "big integer": b'{"limits": {"seconds": ' + b"9" * 5000 + b"}}",
    "wide": b'{"phases": [' + b"0," * 1_000_000 + b"0]}",
    "long name": b'{"name": "' + b"x" * 4_000_000 + b'"}',
    "byte order mark": b"\xef\xbb\xbf{}",
    "trailing": b"{} {}",
}


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES.keys())
def test_broken_documents(client: AppClient, body: bytes) -> None:
    reply = client.post("/v1/jobs", content=body, headers=JSON)
    assert reply.status_code == 422
    assert reply.json()["errors"]
    assert len(reply.content) < 50_000


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"Content-Type": "text/plain"},
        {"Content-Type": "application/x-www-form-urlencoded"},
        {"Content-Type": "multipart/form-data; boundary=x"},
        {"Content-Type": "application/json; charset=utf-16"},
        {"Content-Type": "application/json", "Content-Encoding": "gzip"},
        {"Content-Type": "nonsense;;;=\u00ff".encode("latin-1")},
    ],
)
def test_other_content_types(client: AppClient, headers: dict[str, Any]) -> None:
    body = orjson.dumps(examples.load("cart_pole"))
    reply = client.post("/v1/jobs", content=body, headers=headers)
    assert reply.status_code == 415
    assert "application/json" in reply.json()["hint"]


class TestTooLarge:
    BODY = b'{"name": "' + b"x" * 10_000_000 + b'"}'

    def test_ten_megabytes(self, client: AppClient) -> None:
        reply = client.post("/v1/jobs", content=self.BODY, headers=JSON)
        assert reply.status_code == 413
        assert reply.json()["type"] == "/problems/body-too-large"
        assert "5,000,000" in reply.json()["detail"]

    def test_ten_megabytes_in_chunks(self, client: AppClient) -> None:
        async def chunks() -> Any:
            for start in range(0, len(self.BODY), 65_536):
                yield self.BODY[start : start + 65_536]

        reply = client.post("/v1/jobs", content=chunks(), headers=JSON)
        assert reply.status_code == 413

    def test_everywhere(self, client: AppClient) -> None:
        assert client.post("/v1/jobs/x/cancel", content=self.BODY).status_code == 413
        assert client.request("GET", "/livez", content=self.BODY).status_code == 413


IMPOSSIBLE = {
    "lower over upper": lambda p: p["phases"][0]["bounds"].update(u=[1, -1]),
    "initial out of bounds": lambda p: p["phases"][0]["initial"].update(q1=99),
    "derivative missing": lambda p: p["phases"][0]["system"]["derivatives"].pop("q1"),
    "derivative of nothing": lambda p: p["phases"][0]["system"]["derivatives"].update(z="1"),
    "name twice": lambda p: p["phases"][0]["system"]["states"].append("q1"),
    "reserved name": lambda p: p["phases"][0]["system"]["controls"].append("pi"),
    "time backwards": lambda p: p["phases"][0]["time"].update(final=-1),
    "guess of another length": lambda p: p.update(
        guess={"kind": "points", "time": [0, 1], "values": {"q1": [0, 1, 2]}}
    ),
    "unknown method": lambda p: p.update(method={"kind": "magic"}),
    "too many segments": lambda p: p.update(method={"kind": "trapezoidal", "segments": 10**9}),
    "no phases": lambda p: p.update(phases=[]),
    "unknown field": lambda p: p.update(metod={}),
    "boolean": lambda p: p["phases"][0]["time"].update(final=True),
    "prototype": lambda p: p.update(__proto__={"x": 1}),
}


@pytest.mark.parametrize("change", IMPOSSIBLE.values(), ids=IMPOSSIBLE.keys())
def test_impossible_problems(client: AppClient, change: Any) -> None:
    problem = examples.load("cart_pole")
    change(problem)
    reply = client.post("/v1/jobs", json=problem)
    assert reply.status_code == 422
    assert reply.json()["errors"][0]["pointer"]


def test_markup_in_a_name_comes_back_as_json_only(client: AppClient) -> None:
    name = "<script>alert(1)</script>"
    job = client.post("/v1/jobs", json=examples.load("cart_pole") | {"name": name}).json()
    assert job["name"] == name
    page = client.get("/")
    assert name not in page.text
    reply = client.get(job["links"]["self"])
    assert reply.headers["content-type"] == "application/json"
    assert reply.headers["x-content-type-options"] == "nosniff"


JSON_VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=20,
)
FIELDS = st.sampled_from(sorted(examples.load("cart_pole")))
PHASE_FIELDS = st.sampled_from(sorted(examples.load("cart_pole")["phases"][0]))
HYPOTHESIS = settings(
    max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


class TestRandom:
    def check(self, client: AppClient, body: bytes, allowed: set[int]) -> None:
        reply = client.post("/v1/jobs?validate_only=true", content=body, headers=JSON)
        assert reply.status_code in allowed, reply.text

    @HYPOTHESIS
    @given(st.binary(max_size=300))
    def test_bytes(self, client: AppClient, body: bytes) -> None:
        self.check(client, body, {422})

    @HYPOTHESIS
    @given(JSON_VALUES)
    def test_values(self, client: AppClient, value: Any) -> None:
        self.check(client, json.dumps(value).encode(), {422})

    @HYPOTHESIS
    @given(FIELDS, JSON_VALUES)
    def test_fields(self, client: AppClient, field: str, value: Any) -> None:
        problem = examples.load("cart_pole") | {field: value}
        self.check(client, json.dumps(problem).encode(), {200, 422})

    @HYPOTHESIS
    @given(PHASE_FIELDS, JSON_VALUES)
    def test_phase_fields(self, client: AppClient, field: str, value: Any) -> None:
        problem = examples.load("cart_pole")
        problem["phases"][0][field] = value
        self.check(client, json.dumps(problem).encode(), {200, 422})

    @HYPOTHESIS
    @given(st.text(alphabet=st.sampled_from("uq12.+-*/^()eE, \tsincomaxd"), max_size=60))
    def test_expressions(self, client: AppClient, text: str) -> None:
        self.check(client, orjson.dumps(with_expression(text)), {200, 422})
