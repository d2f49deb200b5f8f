"""POST /v1/simulations, and what is then served like any other job."""

import threading
from typing import Any

import httpx
import orjson
import pytest

from api.app import create_app
from api.settings import ApiSettings
from schemas.jobs import JobKind, JobStatus
from schemas.reading import written
from schemas.simulations import read_simulation
from store.ports import Store
from tests.support.asgi import AppClient, app_client
from tests.support.motions import height, rolling, throw
from tests.support.service import THROW, wait_until
from tests.support.solutions import block_move
from tests.unit.api.conftest import Hand
from tests.unit.api.test_names import block


def post(
    client: AppClient, document: dict[str, Any] | None = None, **options: Any
) -> httpx.Response:
    return client.post("/v1/simulations", json=document or THROW, **options)


def simulated(client: AppClient, hand: Hand, result: dict[str, Any] | None = None) -> str:
    job_id = str(post(client).json()["id"])
    hand.end(hand.start(job_id), result=result or throw())
    return f"/v1/jobs/{job_id}"


def test_it_is_stored_queued_and_answered_as_a_job(client: AppClient, store: Store) -> None:
    reply = post(client)
    assert reply.status_code == 202
    job = reply.json()
    assert reply.headers["location"] == job["links"]["self"] == f"/v1/jobs/{job['id']}"
    assert int(reply.headers["retry-after"]) >= 1
    assert (job["kind"], job["status"], job["name"]) == ("simulation", "queued", "throw")
    assert store.queue.waiting() == [job["id"]]
    assert store.jobs.get(job["id"]).kind is JobKind.SIMULATION
    stored = store.jobs.problem(job["id"])
    assert stored == written(read_simulation(THROW))


def test_limits_are_capped(client: AppClient, store: Store) -> None:
    asked = THROW | {"limits": {"seconds": 80_000, "megabytes": 900_000}}
    record = store.jobs.get(post(client, asked).json()["id"])
    assert (record.seconds, record.megabytes) == (3600, 8192)
    told = post(client, asked, params={"validate_only": "true"}).json()
    assert [warning.split(":")[0] for warning in told["warnings"]] == [
        "/limits/seconds",
        "/limits/megabytes",
    ]


def test_validation_stores_nothing(client: AppClient, store: Store) -> None:
    reply = post(client, params={"validate_only": "true"})
    assert reply.status_code == 200
    assert reply.json()["valid"]
    assert store.jobs.list("local").records == []


def test_a_bad_one_is_refused_with_place_reason_and_mend(client: AppClient) -> None:
    wrong = THROW | {"system": THROW["system"] | {"derivatives": {"y": "vv", "v": "-9.81"}}}
    reply = post(client, wrong)
    assert reply.status_code == 422
    assert reply.headers["content-type"] == "application/problem+json"
    (found,) = reply.json()["errors"]
    assert found["pointer"] == "/system/derivatives/y"
    assert found["column"] == 1
    assert "'v'" in found["hint"]


def test_a_problem_is_no_simulation_nor_the_other_way_round(client: AppClient) -> None:
    assert post(client, block()).status_code == 422
    assert client.post("/v1/jobs", json=THROW).status_code == 422


def test_a_key_stands_for_one_kind_of_request(client: AppClient, store: Store) -> None:
    key = {"Idempotency-Key": "k1"}
    first = post(client, headers=key).json()["id"]
    again = post(client, headers=key)
    assert again.headers["idempotency-replayed"] == "true"
    assert again.json()["id"] == first
    assert len(store.queue.waiting()) == 1
    assert client.post("/v1/jobs", json=block(), headers=key).json()["type"].endswith("key-reused")


def test_who_waits_gets_the_result(client: AppClient, hand: Hand, store: Store) -> None:
    def work() -> None:
        job_id = wait_until(store.queue.waiting)[0]
        hand.end(hand.start(job_id), result=throw())

    worker = threading.Thread(target=work)
    worker.start()
    reply = post(client, headers={"Prefer": "wait=20"})
    worker.join()
    assert reply.status_code == 200
    assert reply.headers["preference-applied"] == "wait=20"
    assert reply.json()["solution_status"] == "finished"
    assert reply.json()["result"] == throw()


def test_the_listing_tells_the_kinds_apart(client: AppClient) -> None:
    simulation = post(client).json()["id"]
    solve = client.post("/v1/jobs", json=block()).json()["id"]

    def listed(**query: str) -> list[str]:
        return [job["id"] for job in client.get("/v1/jobs", params=query).json()["jobs"]]

    assert listed() == [solve, simulation]
    assert listed(kind="simulation") == [simulation]
    assert listed(kind="solve") == [solve]
    assert client.get("/v1/jobs", params={"kind": "odd"}).status_code == 422


def test_its_result_is_served_and_resampled(client: AppClient, hand: Hand) -> None:
    path = simulated(client, hand)
    assert client.get(f"{path}/result").json() == throw()
    sampled = client.get(f"{path}/trajectory", params={"samples": 4, "fields": "y"}).json()
    (phase,) = sampled["phases"]
    series = phase["groups"]["states"]
    assert series["values"]["y"] == pytest.approx([height(t) for t in series["time"]])


def test_its_report_is_drawn_where_the_worker_left_none(client: AppClient, hand: Hand) -> None:
    path = simulated(client, hand, throw(rolling()))
    reply = client.get(f"{path}/report.html")
    assert reply.status_code == 200
    assert "Footfall simulation" in reply.text
    assert 'id="motion"' in reply.text


def test_its_states_are_those_of_jobs(client: AppClient, hand: Hand) -> None:
    job_id = str(post(client).json()["id"])
    path = f"/v1/jobs/{job_id}"
    assert client.get(f"{path}/result").status_code == 409
    assert client.post(f"{path}/cancel").json()["status"] == "cancelled"
    assert client.get(f"{path}/result").json()["type"] == "/problems/no-result"
    assert client.delete(path).status_code == 204
    assert client.get(path).status_code == 404


class TestNames:
    def test_a_system_of_the_gallery(self, client: AppClient, store: Store) -> None:
        named = THROW | {"system": {"kind": "library", "name": "cart_pole"}, "initial": {}}
        job = post(client, named).json()
        stored = orjson.loads(store.jobs.problem(job["id"]))
        assert stored["system"]["states"] == ["q1", "q2", "v1", "v2"]
        ball = THROW | {"system": {"kind": "library", "name": "bouncing_ball"}, "initial": {}}
        stored = orjson.loads(store.jobs.problem(post(client, ball).json()["id"]))
        assert list(stored["system"]["bodies"]) == ["ball"]
        wrong = THROW | {"system": {"kind": "library", "name": "cart_pol"}}
        (found,) = post(client, wrong).json()["errors"]
        assert found["pointer"] == "/system/name"
        assert "cart_pole" in found["hint"]

    def test_the_controls_and_reference_of_a_job(
        self, client: AppClient, store: Store, hand: Hand
    ) -> None:
        solve = client.post("/v1/jobs", json=block()).json()["id"]
        hand.solve(solve)
        pushed = {
            "name": "block again",
            "system": {
                "kind": "ode",
                "states": ["q", "v"],
                "controls": ["u"],
                "derivatives": {"q": "v", "v": "u"},
            },
            "controls": {"from_job": solve},
            "feedback": {"gains": {"u": {"q": 1}}, "reference": {"from_job": solve}},
            "duration": 1,
        }
        job = post(client, pushed).json()
        client.delete(f"/v1/jobs/{solve}")
        stored = orjson.loads(store.jobs.problem(job["id"]))
        curves = block_move()["phases"][0]["curves"]
        for signal in (stored["controls"], stored["feedback"]["reference"]):
            assert signal["kind"] == "solution"
            assert signal["phases"][0]["curves"]["controls"] == curves["controls"]
        missing = pushed | {"controls": {"from_job": "0" * 32}}
        (found,) = post(client, missing | {"feedback": None}).json()["errors"]
        assert found["pointer"] == "/controls/from_job"

    def test_a_simulation_may_start_a_solve(
        self, client: AppClient, store: Store, hand: Hand
    ) -> None:
        path = simulated(client, hand)
        guessed = block(guess={"from_job": path.rsplit("/", 1)[1]})
        job = client.post("/v1/jobs", json=guessed).json()
        assert orjson.loads(store.jobs.problem(job["id"]))["guess"]["kind"] == "solution"


def test_owners_do_not_see_each_others(store: Store) -> None:
    keys = {"key-of-ann-0123456789": "ann", "key-of-bob-0123456789": "bob"}
    ann, bob = ({"Authorization": f"Bearer {key}"} for key in keys)
    with app_client(create_app(store, ApiSettings(keys=keys))) as client:
        assert post(client).status_code == 401
        path = post(client, headers=ann).headers["location"]
        assert client.get(path, headers=ann).status_code == 200
        assert client.get(path, headers=bob).status_code == 404


def test_waiting_simulations_count_into_the_share(store: Store) -> None:
    with app_client(create_app(store, ApiSettings(max_waiting_jobs=1))) as client:
        assert post(client).status_code == 202
        refused = post(client)
        assert refused.status_code == 429
        assert "retry-after" in refused.headers
        assert store.jobs.live()[0].status is JobStatus.QUEUED


def test_a_document_of_the_other_kind_is_sent_to_its_place(client: AppClient) -> None:
    reply = client.post("/v1/jobs", json=THROW)
    assert reply.status_code == 422
    (found,) = reply.json()["errors"]
    assert "POST /v1/simulations" in found["hint"]


def test_what_is_hardly_meant_is_a_warning(client: AppClient) -> None:
    system = {
        "kind": "mechanism",
        "bodies": {"rod": {"mass": 1, "inertia": 0.01, "com": [0, -0.5]}},
        "joints": {"pivot": {"kind": "revolute", "child": "rod", "limits": [-90, 90]}},
    }
    told = post(client, {"system": system, "duration": 1}, params={"validate_only": "true"})
    (warning,) = told.json()["warnings"]
    assert warning.startswith("/system/joints/pivot/limits: an angle of 90 rad")
