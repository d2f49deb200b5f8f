"""Result, trajectory and report."""

import io
from typing import Any

import numpy as np
import pytest

import examples
from api.negotiation import choose
from api.settings import ApiSettings
from schemas.jobs import JobStatus
from store.memory import connect
from store.ports import Store
from store.settings import StoreSettings
from tests.support.asgi import AppClient
from tests.support.solutions import block_move, control, states
from tests.unit.api.conftest import Hand


def post(client: AppClient) -> str:
    return str(client.post("/v1/jobs", json=examples.load("block_min_force")).json()["id"])


@pytest.fixture
def solved(client: AppClient, hand: Hand) -> str:
    job_id = post(client)
    hand.solve(job_id, report=b"<!doctype html><title>block</title>")
    return f"/v1/jobs/{job_id}"


class TestResult:
    def test_it_is_served_as_it_was_stored(self, client: AppClient, solved: str) -> None:
        reply = client.get(f"{solved}/result")
        assert reply.status_code == 200
        assert reply.json() == block_move()
        again = client.get(f"{solved}/result", headers={"If-None-Match": reply.headers["etag"]})
        assert again.status_code == 304

    def test_not_ready(self, client: AppClient, hand: Hand) -> None:
        job_id = post(client)
        hand.start(job_id)
        for name in ("result", "trajectory", "report.html"):
            reply = client.get(f"/v1/jobs/{job_id}/{name}")
            assert reply.status_code == 409
            assert reply.json()["type"] == "/problems/result-not-ready"
            assert "retry-after" in reply.headers

    def test_the_best_iterate_of_a_cancelled_job(self, client: AppClient, hand: Hand) -> None:
        job_id = post(client)
        record = hand.start(job_id)
        client.post(f"/v1/jobs/{job_id}/cancel")
        hand.end(record, JobStatus.CANCELLED, result=block_move() | {"status": "cancelled"})
        assert client.get(f"/v1/jobs/{job_id}/result").json()["status"] == "cancelled"

    def test_a_snapshot_of_a_running_job(self, client: AppClient, hand: Hand, store: Store) -> None:
        job_id = post(client)
        record = hand.start(job_id)
        store.results.put(job_id, record.token, b'{"status": "cancelled"}')
        assert client.get(f"/v1/jobs/{job_id}/result").status_code == 200

    def test_there_never_will_be_one(self, client: AppClient, hand: Hand) -> None:
        job_id = post(client)
        hand.end(hand.start(job_id), JobStatus.FAILED)
        reply = client.get(f"/v1/jobs/{job_id}/result")
        assert reply.status_code == 404
        assert reply.json()["type"] == "/problems/no-result"


class TestExpired:
    @pytest.fixture
    def store(self) -> Store:
        return connect(StoreSettings(retention=0))

    @pytest.mark.parametrize("name", ["result", "trajectory", "report.html"])
    def test_the_record_outlives_the_result(
        self, client: AppClient, solved: str, name: str
    ) -> None:
        assert client.get(solved).json()["status"] == "expired"
        reply = client.get(f"{solved}/{name}")
        assert reply.status_code == 410
        assert reply.json()["type"] == "/problems/result-expired"


class TestTrajectory:
    def test_samples_lie_on_the_curves(self, client: AppClient, solved: str) -> None:
        document = client.get(f"{solved}/trajectory?samples=7").json()
        assert document["status"] == "converged"
        groups = document["phases"][0]["groups"]
        times = groups["states"]["time"]
        assert times == pytest.approx(np.linspace(0, 1, 7))
        expected = [states(t) for t in times]
        assert groups["states"]["values"]["q"] == pytest.approx([q for q, _ in expected])
        assert groups["states"]["values"]["v"] == pytest.approx([v for _, v in expected])
        assert groups["controls"]["values"]["u"] == pytest.approx([control(t) for t in times])

    @pytest.mark.parametrize(("dt", "count"), [(0.25, 5), (0.3, 5), (1, 2), (7, 2), (0.1, 11)])
    def test_steps_end_at_the_end(
        self, client: AppClient, solved: str, dt: float, count: int
    ) -> None:
        document = client.get(f"{solved}/trajectory?dt={dt}").json()
        times = document["phases"][0]["groups"]["states"]["time"]
        assert len(times) == count
        assert times[-1] == 1
        assert np.diff(times)[:-1] == pytest.approx(dt)

    @pytest.mark.parametrize(
        ("fields", "groups"),
        [
            ("q", {"states": ["q"]}),
            ("controls", {"controls": ["u"]}),
            ("states.v, u", {"states": ["v"], "controls": ["u"]}),
        ],
    )
    def test_fields(
        self, client: AppClient, solved: str, fields: str, groups: dict[str, list[str]]
    ) -> None:
        document = client.get(f"{solved}/trajectory", params={"fields": fields}).json()
        found = document["phases"][0]["groups"]
        assert {name: list(group["values"]) for name, group in found.items()} == groups

    def test_csv(self, client: AppClient, solved: str) -> None:
        reply = client.get(f"{solved}/trajectory?samples=3", headers={"Accept": "text/csv"})
        assert reply.headers["content-type"].startswith("text/csv")
        head, *rows = reply.text.strip().split("\n")
        assert head == "phase,time,q,v,u"
        assert rows[1].startswith("move,0.5,")
        assert [float(cell) for cell in rows[1].split(",")[1:]] == pytest.approx([0.5, 0.5, 1.5, 0])

    def test_npz(self, client: AppClient, solved: str) -> None:
        reply = client.get(
            f"{solved}/trajectory?samples=3", headers={"Accept": "application/x-npz"}
        )
        arrays = np.load(io.BytesIO(reply.content), allow_pickle=False)
        assert sorted(arrays) == ["move/controls/u", "move/states/q", "move/states/v", "move/time"]
        assert arrays["move/states/q"] == pytest.approx([0, 0.5, 1])

    def test_other_types_are_refused(self, client: AppClient, solved: str) -> None:
        reply = client.get(f"{solved}/trajectory", headers={"Accept": "image/png"})
        assert reply.status_code == 406
        assert "text/csv" in reply.json()["hint"]

    @pytest.mark.parametrize(
        ("query", "parameter"),
        [
            ("samples=1", "samples"),
            ("samples=100001", "samples"),
            ("samples=1e3", "samples"),
            ("dt=0", "dt"),
            ("dt=nan", "dt"),
            ("dt=inf", "dt"),
            ("dt=1e-300", "dt"),
            ("dt=5e-324", "dt"),
            ("dt=0.1&samples=3", "dt"),
            ("fields=nothing", "fields"),
            ("fields=", "fields"),
            ("fields=q,%00", "fields"),
        ],
    )
    def test_malformed_parameters_are_named(
        self, client: AppClient, solved: str, query: str, parameter: str
    ) -> None:
        reply = client.get(f"{solved}/trajectory?{query}")
        assert reply.status_code == 422
        assert reply.json()["errors"][0]["parameter"] == parameter

    @pytest.mark.parametrize("samples", [2, 100_000])
    def test_the_ends_of_the_range(self, client: AppClient, solved: str, samples: int) -> None:
        reply = client.get(f"{solved}/trajectory?samples={samples}&fields=q")
        times = reply.json()["phases"][0]["groups"]["states"]["time"]
        assert (len(times), times[0], times[-1]) == (samples, 0, 1)


class TestReport:
    def test_it_can_do_nothing_but_show_itself(self, client: AppClient, solved: str) -> None:
        reply = client.get(f"{solved}/report.html")
        assert reply.headers["content-type"].startswith("text/html")
        assert "<title>block" in reply.text
        policy = reply.headers["content-security-policy"]
        assert "default-src 'none'" in policy
        assert "sandbox allow-scripts" in policy
        assert "allow-same-origin" not in policy

    def test_it_is_drawn_here_where_the_worker_has_not(self, client: AppClient, hand: Hand) -> None:
        job_id = post(client)
        hand.solve(job_id)
        reply = client.get(f"/v1/jobs/{job_id}/report.html")
        assert reply.status_code == 200
        assert "block move" in reply.text

    def test_there_is_none(self, client: AppClient, hand: Hand) -> None:
        undrawable = post(client)
        hand.end(hand.start(undrawable), result={"status": "converged", "phases": 7})
        without_result = post(client)
        hand.end(hand.start(without_result), JobStatus.FAILED)
        for job_id in (undrawable, without_result):
            reply = client.get(f"/v1/jobs/{job_id}/report.html")
            assert reply.status_code == 404
            assert reply.json()["type"] == "/problems/no-result"


@pytest.mark.parametrize(
    ("accept", "chosen"),
    [
        (None, "a/json"),
        ("", "a/json"),
        ("*/*", "a/json"),
        ("b/csv", "b/csv"),
        ("a/*;q=0.1, b/csv;q=0.9", "b/csv"),
        ("a/json;q=0, */*", "b/csv"),
        ("A/JSON", "a/json"),
        ("c/none", None),
        (",;,q=", None),
        ("a/json;q=odd", "a/json"),
        ("a/json;q=nan", "a/json"),
    ],
)
def test_negotiation(accept: str | None, chosen: str | None) -> None:
    assert choose(accept, ("a/json", "b/csv")) == chosen


class TestSmallCap:
    @pytest.fixture
    def settings(self) -> ApiSettings:
        return ApiSettings(max_samples=10)

    def test_the_cap_is_the_settings(self, client: AppClient, solved: str) -> None:
        assert client.get(f"{solved}/trajectory?samples=10").status_code == 200
        reply = client.get(f"{solved}/trajectory?dt=0.05")
        assert reply.status_code == 422
        assert "10" in reply.json()["detail"]


def test_a_phase_without_a_series_leaves_its_cells_empty(client: AppClient, hand: Hand) -> None:
    job_id = post(client)
    result: dict[str, Any] = block_move()
    second = {**result["phases"][0], "name": "rest"}
    second["curves"] = {"states": second["curves"]["states"]}
    result["phases"].append(second)
    hand.end(hand.start(job_id), result=result)
    url = f"/v1/jobs/{job_id}/trajectory?samples=2"
    rows = client.get(url, headers={"Accept": "text/csv"}).text.strip().split("\n")
    phase, time, _, _, u = rows[-1].split(",")
    assert (phase, time, u) == ("rest", "1.0", "")
