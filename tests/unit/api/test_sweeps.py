"""POST /v1/sweeps and what follows, with a hand that plays the worker."""

from typing import Any

import pytest

import examples
from api.settings import ApiSettings
from schemas.jobs import JobStatus
from schemas.limits import MODEL_LIMITS
from schemas.sweeps import ChunkPlan, PointOutcome, PointStatus
from store.memory import connect
from store.ports import JobRecord, Store
from store.settings import StoreSettings
from tests.support.asgi import AppClient
from tests.unit.api.conftest import LIVE, Hand

MASS = "/phases/0/system/parameters/m1"
FINAL = "/phases/0/time/final"


def sweep(**changes: Any) -> dict[str, Any]:
    """Twelve points of the block: four lengths of time by three distances."""
    grid = {FINAL: [1, 2, 3, 4], "/phases/0/final/x": [1, 2, 3]}
    return {"problem": examples.load("block_min_force"), "grid": grid} | changes


def post(client: AppClient, document: dict[str, Any] | None = None, **options: Any) -> Any:
    reply = client.post("/v1/sweeps", json=document or sweep(), **options)
    assert reply.status_code == 202, reply.text
    return reply.json()


def refused(client: AppClient, document: dict[str, Any]) -> dict[str, str]:
    """Pointer -> message of each issue."""
    reply = client.post("/v1/sweeps", json=document)
    assert reply.status_code == 422, reply.text
    return {issue["pointer"]: issue["message"] for issue in reply.json()["errors"]}


def outcome(objective: float, verdict: str = "certified", status: str = "converged") -> Any:
    return PointOutcome(
        status=PointStatus.SUCCEEDED,
        solution_status=status,
        objective=objective,
        verdict=verdict,
        iterations=7,
    )


def solve(store: Store, hand: Hand, job_id: str, objectives: list[float]) -> JobRecord:
    """Solve as many points of a chunk as there are objectives; the job runs on."""
    record = hand.start(job_id)
    first = ChunkPlan.model_validate_json(store.jobs.problem(job_id)).first
    for index, objective in enumerate(objectives, first):
        assert store.sweeps.begin(record.sweep, index, record)
        result = b'{"objective": %d}' % objective
        assert store.sweeps.end(record.sweep, index, record, outcome(objective), result)
    return record


class TestPosting:
    def test_a_sweep_is_a_parent_of_chunks(self, client: AppClient, store: Store) -> None:
        reply = client.post("/v1/sweeps", json=sweep())
        made = reply.json()
        assert reply.headers["location"] == made["links"]["self"] == f"/v1/sweeps/{made['id']}"
        assert (made["status"], made["kind"], made["total"]) == ("queued", "grid", 12)
        assert made["counts"]["queued"] == 12
        assert made["points"][4]["values"] == {FINAL: 2, "/phases/0/final/x": 2}
        jobs = store.queue.waiting()
        assert [point["links"]["job"] for point in made["points"]] == [
            f"/v1/jobs/{jobs[index // 6]}" for index in range(12)
        ]
        record = store.jobs.get(jobs[0])
        assert (record.kind, record.sweep, record.points) == ("sweep_chunk", made["id"], 6)
        assert record.seconds == 6 * 600

    def test_its_jobs_are_reached_but_not_listed(self, client: AppClient) -> None:
        made = post(client)
        job = client.get(made["points"][0]["links"]["job"]).json()
        assert job["kind"] == "sweep_chunk"
        assert job["links"]["sweep"] == made["links"]["self"]
        assert client.get("/v1/jobs").json()["jobs"] == []
        refusal = client.delete(job["links"]["self"])
        assert refusal.status_code == 409
        assert made["id"] in refusal.json()["hint"]
        missing = client.get(f"{job['links']['self']}/result")
        assert missing.status_code == 404
        assert made["id"] in missing.json()["hint"]

    def test_a_list_of_points(self, client: AppClient) -> None:
        points = [{FINAL: 1}, {FINAL: 2, "/method/segments": 5}]
        made = post(client, {"problem": sweep()["problem"], "points": points, "name": "two"})
        assert [point["values"] for point in made["points"]] == points
        assert (made["name"], made["kind"], made["chunk"]) == ("two", "points", 2)

    def test_guesses_are_points_of_their_own_jobs(self, client: AppClient, store: Store) -> None:
        problem = sweep()["problem"]
        own = {"kind": "random", "seed": 5, "spread": 0.5, "duration": 2.0}
        problem["phases"][0]["guess"] = own
        problem["multistart"] = 7
        made = post(client, {"problem": problem, "multistart": 3})
        assert (made["chunk"], made["warm"], len(store.queue.waiting())) == (1, False, 3)
        assert [point["values"] for point in made["points"]] == [
            {"/multistart": 1},
            *(
                {
                    "/guess": {"kind": "random", "seed": number},
                    "/phases/0/guess": own | {"spread": 0.5, "seed": 5 + number},
                    "/multistart": 1,
                }
                for number in (1, 2)
            ),
        ]

    def test_validate_only_stores_nothing(self, client: AppClient, store: Store) -> None:
        reply = client.post("/v1/sweeps?validate_only=true", json=sweep(chunk=5))
        assert reply.status_code == 200
        assert reply.json()["jobs"] == 3
        assert store.queue.waiting() == []
        assert client.get("/v1/sweeps").json()["sweeps"] == []

    def test_names_are_put_in_before_points_are(self, client: AppClient) -> None:
        problem = examples.load("cart_pole")
        problem["phases"][0]["system"] = {"kind": "library", "name": "cart_pole"}
        made = post(client, {"problem": problem, "grid": {MASS: [1, 2]}})
        assert made["total"] == 2


class TestRefusals:
    @pytest.mark.parametrize(
        ("changes", "pointer", "words"),
        [
            ({"grid": None}, "", "one thing"),
            ({"points": [{}]}, "/points", "one thing"),
            ({"grid": {}}, "/grid", "no point"),
            ({"grid": {FINAL: []}}, "/grid", "no point"),
            ({"grid": {FINAL: [*range(1, 1002)]}}, "/grid", "'sweep'"),
            ({"grid": {"/phases/0/tim/final": [1]}}, "/grid/~1phases~10~1tim~1final/0", "no 'tim'"),
            ({"grid": {"phases": [1]}}, "/grid/phases/0", "begins with /"),
            ({"grid": {"/phases/7/name": ["a"]}}, "/grid/~1phases~17~1name/0", "no place"),
            ({"grid": {FINAL: [1, "x+"]}}, "/grid/~1phases~10~1time~1final/1", ""),
            ({"grid": {FINAL: [1, -1]}}, "/grid/~1phases~10~1time~1final/1", ""),
            ({"chunk": 0}, "/chunk", ""),
            ({"grids": {}}, "/grids", "unknown field"),
            ({"problem": {"phases": []}}, "/problem/phases", ""),
            ({"grid": None, "multistart": 3, "warm": True}, "/warm", "independent"),
            ({"grid": None, "multistart": MODEL_LIMITS.multistart + 1}, "/multistart", ""),
        ],
    )
    def test_each_at_its_place(
        self, client: AppClient, changes: dict[str, Any], pointer: str, words: str
    ) -> None:
        found = refused(client, sweep(**changes))
        assert pointer in found, found
        assert words in found[pointer]

    def test_a_consequence_is_told_at_the_point(self, client: AppClient) -> None:
        """The end outside of the bounds is nobody's value in particular."""
        problem = sweep()["problem"]
        problem["phases"][0]["bounds"] = {"x": [0, 5]}
        points = [{"/phases/0/bounds/x": [0, 2]}, {"/phases/0/bounds/x": [0, 0.5]}]
        found = refused(client, {"problem": problem, "points": points})
        assert list(found) == ["/points/1"]
        assert "at point 1, /phases/0/final/x" in found["/points/1"]

    def test_points_times_values_have_a_limit(self, client: AppClient) -> None:
        times = [float(k) for k in range(5000)]
        problem = sweep()["problem"]
        problem["guess"] = {"kind": "points", "time": times, "values": {"x": times}}
        found = refused(client, {"problem": problem, "grid": {FINAL: [*range(1, 301)]}})
        assert "'sweep_values'" in found[""]

    @pytest.mark.parametrize("settings", [ApiSettings(max_waiting_jobs=2)])
    def test_more_jobs_than_may_wait_are_never_accepted(self, client: AppClient) -> None:
        assert "6 jobs" in refused(client, sweep(chunk=2))["/chunk"]


class TestSharesAndKeys:
    @pytest.fixture
    def settings(self) -> ApiSettings:
        return ApiSettings(max_waiting_jobs=3)

    def test_all_jobs_count(self, client: AppClient) -> None:
        post(client)
        reply = client.post("/v1/sweeps", json=sweep())
        assert reply.status_code == 429
        assert client.get("/v1/sweeps").json()["sweeps"][0]["total"] == 12

    def test_the_same_key_makes_no_second_sweep(self, client: AppClient, store: Store) -> None:
        key = {"Idempotency-Key": "k"}
        first = post(client, headers=key)
        again = client.post("/v1/sweeps", json=sweep(), headers=key)
        assert again.json()["id"] == first["id"]
        assert again.headers["idempotency-replayed"] == "true"
        assert len(store.queue.waiting()) == 2
        other = client.post("/v1/sweeps", json=sweep(chunk=7), headers=key)
        assert other.json()["type"] == "/problems/key-reused"
        job = client.post("/v1/jobs", json=sweep()["problem"], headers=key)
        assert job.json()["type"] == "/problems/key-reused"

    @pytest.mark.parametrize("store", [connect(StoreSettings(queue_limit=1))])
    def test_a_full_queue_leaves_nothing_behind(self, client: AppClient, store: Store) -> None:
        reply = client.post("/v1/sweeps", json=sweep(), headers={"Idempotency-Key": "k"})
        assert reply.status_code == 503
        assert client.get("/v1/sweeps").json()["sweeps"] == []
        assert (store.jobs.live(), store.queue.waiting()) == ([], [])
        assert client.post(
            "/v1/sweeps", json=sweep(chunk=12), headers={"Idempotency-Key": "k"}
        ).is_success


class TestLooking:
    def test_points_as_they_end(self, client: AppClient, store: Store, hand: Hand) -> None:
        url = post(client)["links"]["self"]
        first, _ = store.queue.waiting()
        record = solve(store, hand, first, [5.0, 4.0])
        store.sweeps.begin(record.sweep, 2, record)
        seen = client.get(url).json()
        assert seen["status"] == "running"
        states = [point["status"] for point in seen["points"]]
        assert states == ["succeeded"] * 2 + ["running"] + ["queued"] * 9
        assert seen["counts"]["queued"] == 9
        assert seen["points"][1]["objective"] == 4.0
        assert "result" not in seen["points"][2]["links"]
        reply = client.get(seen["points"][1]["links"]["result"])
        assert reply.json() == {"objective": 4}
        assert client.get(f"{url}/points/2/result").status_code == 409
        assert client.get(f"{url}/points/12/result").json()["type"] == "/problems/unknown-sweep"

    def test_fields_choose(self, client: AppClient) -> None:
        url = post(client)["links"]["self"]
        seen = client.get(f"{url}?fields=objective,status").json()
        assert seen["points"][3] == {"index": 3, "status": "queued", "objective": None}
        assert client.get(f"{url}?fields=").json()["points"] == []
        refusal = client.get(f"{url}?fields=objektive")
        assert refusal.status_code == 422
        assert "objective" in refusal.json()["errors"][0]["hint"]

    def test_a_lost_chunk_fails_its_points_and_no_others(
        self, client: AppClient, store: Store, hand: Hand
    ) -> None:
        url = post(client)["links"]["self"]
        first, second = store.queue.waiting()
        hand.end(solve(store, hand, first, [1.0] * 6))
        lost = solve(store, hand, second, [1.0])
        store.jobs.move(second, JobStatus.FAILED, expect=LIVE, token=lost.token)
        seen = client.get(url).json()
        assert (seen["status"], seen["counts"]["succeeded"]) == ("failed", 7)
        assert client.get(f"{url}/points/8/result").json()["type"] == "/problems/no-result"

    def test_guesses_give_the_distinct_minima(
        self, client: AppClient, store: Store, hand: Hand
    ) -> None:
        made = post(client, {"problem": sweep()["problem"], "multistart": 5})
        ends = [
            outcome(12.0),
            outcome(11.0),
            outcome(12.0 * (1 + 5e-7)),
            outcome(12.0, verdict="not_certified"),
            outcome(1.0, status="locally_infeasible"),
        ]
        for index, (job_id, end) in enumerate(zip(store.queue.waiting(), ends, strict=True)):
            record = hand.start(job_id)
            store.sweeps.end(made["id"], index, record, end, b"{}")
            hand.end(record)
        seen = client.get(made["links"]["self"]).json()
        assert seen["status"] == "succeeded"
        found = [(m["objective"], m["verdict"], m["points"]) for m in seen["minima"]]
        assert found == [
            (11.0, "certified", [1]),
            (12.0, "certified", [0, 2]),
            (12.0, "not_certified", [3]),
        ]

    def test_newest_first_in_pages(self, client: AppClient) -> None:
        ids = [post(client)["id"] for _ in range(3)]
        page = client.get("/v1/sweeps?limit=2").json()
        rest = client.get("/v1/sweeps", params={"cursor": page["next"]}).json()
        assert [one["id"] for one in page["sweeps"] + rest["sweeps"]] == ids[::-1]
        assert rest["next"] is None
        assert page["sweeps"][0]["points"] == []
        assert client.get("/v1/sweeps?cursor=!").status_code == 422

    @pytest.mark.parametrize("sweep_id", ["0" * 32, "x", "%00"])
    def test_an_unknown_sweep_is_404(self, client: AppClient, sweep_id: str) -> None:
        for method, path in [("GET", ""), ("GET", "/points/0/result"), ("POST", "/cancel")]:
            reply = client.request(method, f"/v1/sweeps/{sweep_id}{path}")
            assert reply.status_code == 404
            assert reply.json()["type"] == "/problems/unknown-sweep"


class TestEnding:
    def test_cancel_keeps_what_has_ended(self, client: AppClient, store: Store, hand: Hand) -> None:
        url = post(client)["links"]["self"]
        first, _ = store.queue.waiting()
        record = solve(store, hand, first, [3.0])
        asked = client.post(f"{url}/cancel")
        assert (asked.status_code, asked.json()["status"]) == (202, "cancelling")
        assert store.queue.waiting() == []
        hand.end(record, JobStatus.CANCELLED)
        seen = client.get(url).json()
        assert seen["status"] == "cancelled"
        assert (seen["counts"]["succeeded"], seen["counts"]["cancelled"]) == (1, 11)
        assert client.get(f"{url}/points/0/result").status_code == 200
        assert client.post(f"{url}/cancel").json()["status"] == "cancelled"

    def test_delete_cancels_then_forgets(self, client: AppClient, store: Store, hand: Hand) -> None:
        made = post(client)
        url = made["links"]["self"]
        assert client.delete(url).status_code == 202
        assert client.delete(url).status_code == 204
        assert client.get(url).status_code == 404
        assert client.get(made["points"][0]["links"]["job"]).status_code == 404


class TestOwners:
    KEYS = {"key-of-ann-0123456789": "ann", "key-of-bob-0123456789": "bob"}  # noqa: RUF012

    @pytest.fixture
    def settings(self) -> ApiSettings:
        return ApiSettings(keys=self.KEYS)

    def test_a_foreign_sweep_is_as_unknown_as_none(self, client: AppClient) -> None:
        ann, bob = ({"Authorization": f"Bearer {key}"} for key in self.KEYS)
        url = post(client, headers=ann)["links"]["self"]
        for method, path in [
            ("GET", ""), ("GET", "/points/0/result"), ("POST", "/cancel"), ("DELETE", ""),
        ]:  # fmt: skip
            assert client.request(method, url + path, headers=bob).status_code == 404
        assert client.get("/v1/sweeps", headers=bob).json()["sweeps"] == []
        assert client.get(url, headers=ann).json()["status"] == "queued"
        assert client.get("/v1/sweeps").status_code == 401
