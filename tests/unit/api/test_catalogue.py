"""Examples, methods, backends, schema, limits; and the pages for people."""

import re
from importlib import resources

import pytest
from jsonschema_rs import Draft202012Validator

import examples
from api.errors import TYPES
from schemas.methods import METHODS, SCHEDULES
from schemas.reading import read_problem
from store.ports import Store
from tests.support.asgi import AppClient


def test_every_example_can_be_posted_as_it_is(client: AppClient) -> None:
    listed = client.get("/v1/examples").json()["examples"]
    assert [one["name"] for one in listed] == [*examples.names(), *examples.simulations()]
    assert {one["kind"] for one in listed} == {"problem", "simulation"}
    for one in listed:
        assert one["title"]
        reply = client.post(one["post"], content=client.get(one["href"]).content,
                            headers={"Content-Type": "application/json"})  # fmt: skip
        assert reply.status_code == 202


def test_an_unknown_example_names_the_nearest(client: AppClient) -> None:
    reply = client.get("/v1/examples/cart_poel")
    assert reply.status_code == 404
    assert "cart_pole" in reply.json()["hint"]


@pytest.mark.parametrize("name", ["..%2f__init__", "__init__", "%00"])
def test_only_examples_are_served(client: AppClient, name: str) -> None:
    assert client.get(f"/v1/examples/{name}").status_code == 404


def test_methods_come_with_their_schema(client: AppClient) -> None:
    methods = client.get("/v1/methods").json()["methods"]
    assert len(methods) == len(METHODS) + len(SCHEDULES)
    for method in methods:
        assert method["title"]
        assert method["settings"]["properties"]["kind"]["const"] == method["kind"]


def test_backends_are_those_of_the_live_workers(client: AppClient, store: Store) -> None:
    assert client.get("/v1/backends").json() == {"backends": [], "workers": []}
    for name in "ab":
        store.queue.announce({"name": name, "state": "idle", "backends": ["ipopt"]}, ttl=60)
    store.queue.announce({"name": "c"}, ttl=60)
    reply = client.get("/v1/backends").json()
    assert reply["backends"] == [{"name": "ipopt", "workers": 2}]
    assert len(reply["workers"]) == 3


def test_the_schema_is_a_json_schema(client: AppClient) -> None:
    reply = client.get("/v1/schema")
    assert reply.headers["content-type"] == "application/schema+json"
    schema = reply.json()
    assert schema["$schema"].endswith("2020-12/schema")
    assert schema["additionalProperties"] is False
    assert set(schema["required"]) <= set(schema["properties"])
    assert set(examples.load("cart_pole")) <= set(schema["properties"])


def test_the_schema_has_the_names_that_the_service_replaces(client: AppClient) -> None:
    fits = Draft202012Validator(client.get("/v1/schema").json()).is_valid
    problem = examples.load("cart_pole")
    problem["phases"][0]["system"] = {"kind": "library", "name": "cart_pole"}
    problem["guess"] = problem["phases"][0]["guess"] = {"from_job": "0" * 32}
    assert fits(problem)
    problem["phases"][0]["system"]["parameter"] = {}
    assert not fits(problem)


def test_the_schema_of_simulations_is_one_of_its_own(client: AppClient) -> None:
    fits = Draft202012Validator(client.get("/v1/schema/simulation").json()).is_valid
    system = {"kind": "library", "name": "cart_pole"}
    simulation = {"system": system, "duration": 1, "controls": {"from_job": "0" * 32}}
    assert fits(simulation)
    assert not fits({**simulation, "phases": []})


def test_limits_are_the_enforced_ones(client: AppClient) -> None:
    table = client.get("/v1/limits").json()
    assert table["body_bytes"] == 5_000_000
    assert table["model"]["states"] >= 4
    long = examples.load("cart_pole")
    long["phases"][0]["integrals"]["effort"] = "1" * (table["expression_characters"] + 1)
    reply = client.post("/v1/jobs", json=long)
    assert reply.status_code == 422
    assert str(table["expression_characters"]) in reply.json()["detail"]
    read_problem(examples.load("cart_pole"))


class TestPages:
    def test_the_console_runs_only_its_own_script(self, client: AppClient) -> None:
        page = client.get("/")
        assert page.headers["content-type"].startswith("text/html")
        policy = page.headers["content-security-policy"]
        assert "script-src 'self'" in policy
        assert "unsafe" not in policy
        for name in re.findall(r'(?:src|href)="(/console/[^"]+)"', page.text):
            assert client.get(name).status_code == 200
        assert "<script>" not in page.text
        assert not re.search(r"\son\w+=|style=", page.text)

    def test_the_console_puts_text_in_as_text(self) -> None:
        script = (resources.files("api") / "console" / "console.js").read_text()
        for way_in in ("innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval("):
            assert way_in not in script

    def test_no_other_file_is_served(self, client: AppClient) -> None:
        for name in ("index.html", "..%2fapp.py", "x"):
            assert client.get(f"/console/{name}").status_code == 404

    @pytest.mark.parametrize("code", sorted(kind.code for kind in TYPES.values()))
    def test_every_type_of_error_has_a_page(self, client: AppClient, code: str) -> None:
        reply = client.get(f"/problems/{code}")
        assert reply.status_code == 200
        assert code in reply.text
        assert len(reply.text.splitlines()) >= 3

    def test_an_unknown_type_lists_the_known(self, client: AppClient) -> None:
        reply = client.get("/problems/odd")
        assert reply.status_code == 404
        assert "bad-problem" in reply.json()["hint"]
