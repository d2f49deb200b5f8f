"""What a posted problem only names: systems of the gallery, solutions of earlier jobs."""

from typing import Any

import orjson
import pytest

import examples
from api.app import create_app
from api.settings import ApiSettings
from schemas.jobs import JobStatus
from schemas.reading import read_problem, written
from store.ports import Store
from tests.support.asgi import AppClient, app_client
from tests.support.solutions import block_move
from tests.unit.api.conftest import Hand


def post(client: AppClient, problem: dict[str, Any], **options: Any) -> Any:
    return client.post("/v1/jobs", json=problem, **options)


def block(**changes: Any) -> dict[str, Any]:
    return examples.load("block_min_force") | changes


def library(**changes: Any) -> dict[str, Any]:
    problem = examples.load("cart_pole")
    problem["phases"][0]["system"] = {"kind": "library", "name": "cart_pole"} | changes
    return problem


def issue(client: AppClient, problem: dict[str, Any], **options: Any) -> dict[str, str]:
    reply = post(client, problem, **options)
    assert reply.status_code == 422, reply.text
    (found,) = reply.json()["errors"]
    return found


class TestLibrary:
    def test_a_name_becomes_the_system(self, client: AppClient, store: Store) -> None:
        stored = store.jobs.problem(post(client, library()).json()["id"])
        assert stored == written(read_problem(examples.load("cart_pole")))

    def test_parameters_are_replaced_in_their_order(self, client: AppClient, store: Store) -> None:
        changes = {"l": "m1/4", "m1": 2.0}
        job = post(client, library(parameters=changes)).json()
        system = orjson.loads(store.jobs.problem(job["id"]))["phases"][0]["system"]
        assert list(system["parameters"].items()) == [
            ("m1", 2.0), ("m2", 0.3), ("l", "m1/4"), ("g", 9.81),
        ]  # fmt: skip

    @pytest.mark.parametrize(
        ("changes", "pointer", "hint"),
        [
            ({"name": "cart_pol"}, "/name", "did you mean 'cart_pole'?"),
            ({"name": "../examples/cart_pole"}, "/name", "cart_pole"),
            ({"name": None}, "/name", "cart_pole"),
            ({"parameters": {"mm1": 1}}, "/parameters/mm1", "did you mean 'm1'?"),
            ({"parameters": {"q": 1}}, "/parameters/q", "its parameters are m1, m2, l, g"),
            ({"parameters": [1]}, "/parameters", ""),
            ({"parameters": {"m1": True}}, "/parameters/m1", ""),
            ({"state": []}, "/state", ""),
        ],
    )
    def test_each_mistake_at_its_place(
        self, client: AppClient, changes: dict[str, Any], pointer: str, hint: str
    ) -> None:
        found = issue(client, library(**changes))
        assert found["pointer"] == f"/phases/0/system{pointer}"
        assert hint in found["hint"]


class TestFromJob:
    def test_the_stored_problem_is_self_contained(
        self, client: AppClient, store: Store, hand: Hand
    ) -> None:
        first = post(client, block()).json()["id"]
        hand.solve(first)
        job = post(client, block(guess={"from_job": first})).json()
        assert client.delete(f"/v1/jobs/{first}").status_code == 204
        guess = orjson.loads(store.jobs.problem(job["id"]))["guess"]
        (phase,) = block_move()["phases"]
        assert guess["kind"] == "solution"
        assert guess["phases"][0]["name"] == phase["name"]
        assert guess["phases"][0]["curves"] == {
            name: phase["curves"][name] for name in ("states", "controls")
        }

    def test_a_phase_may_have_its_own(self, client: AppClient, store: Store, hand: Hand) -> None:
        first = post(client, block()).json()["id"]
        hand.solve(first)
        problem = block()
        problem["phases"][0]["guess"] = {"from_job": first}
        job = post(client, problem).json()
        stored = orjson.loads(store.jobs.problem(job["id"]))
        assert stored["phases"][0]["guess"]["kind"] == "solution"
        assert stored["guess"]["kind"] == "points"

    def test_validation_follows_it_too(self, client: AppClient, hand: Hand) -> None:
        first = post(client, block()).json()["id"]
        problem = block(guess={"from_job": first})
        only = {"params": {"validate_only": "true"}}
        assert "has no result yet" in issue(client, problem, **only)["message"]
        hand.solve(first)
        assert post(client, problem, **only).status_code == 200

    def test_what_cannot_be_had_is_told_with_the_reason(
        self, client: AppClient, hand: Hand
    ) -> None:
        failed = post(client, block()).json()["id"]
        hand.end(hand.start(failed), JobStatus.FAILED)
        for value, words in [
            ("0" * 32, "no job"),
            ("nonsense", "no such job"),
            (7, "expected the id"),
            (failed, "ended as failed without a result"),
        ]:
            found = issue(client, block(guess={"from_job": value}))
            assert found["pointer"] == "/guess/from_job"
            assert words in found["message"]
        hand.solve(other := post(client, block()).json()["id"])
        found = issue(client, block(guess={"from_job": other, "kind": "solution"}))
        assert found["pointer"] == "/guess/kind"

    def test_a_foreign_job_is_as_unknown_as_none(self, store: Store, hand: Hand) -> None:
        keys = {"key-of-ann-0123456789": "ann", "key-of-bob-0123456789": "bob"}
        ann, bob = ({"Authorization": f"Bearer {key}"} for key in keys)
        with app_client(create_app(store, ApiSettings(keys=keys))) as client:
            first = post(client, block(), headers=ann).json()["id"]
            hand.solve(first)
            problem = block(guess={"from_job": first})
            foreign = issue(client, problem, headers=bob)
            unknown = issue(client, block(guess={"from_job": "0" * 32}), headers=bob)
            assert foreign["message"].replace(first, "0" * 32) == unknown["message"]
            assert post(client, problem, headers=ann).status_code == 202
