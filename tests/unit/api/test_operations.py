"""What an operator looks at: health, metrics, the log, headers, imports, settings."""

import logging
import subprocess
import sys
from collections.abc import Callable, Iterator
from typing import Any, NoReturn

import pytest

import examples
from api.app import create_app
from api.observing import SECURITY_HEADERS
from api.serve import serve
from api.settings import ApiSettings, SettingsError, from_environment
from schemas.errors import StoreUnavailable
from store.ports import Store
from tests.support.asgi import AppClient, app_client
from tests.unit.api.conftest import Hand


class Gone:
    """Every port of a server that does not answer."""

    def __getattr__(self, name: str) -> Callable[..., NoReturn]:
        def call(*_: object, **__: object) -> NoReturn:
            raise StoreUnavailable("The queue server does not answer.", "Try again later.")

        return call


@pytest.fixture
def gone(settings: ApiSettings) -> Iterator[AppClient]:
    """A client of a service whose store is away; building it must open no connection."""
    port: Any = Gone()
    store = Store(port, port, port, port, port, port, durable=port.durable, ping=port.ping)
    with app_client(create_app(store, settings)) as client:
        yield client


class TestHealth:
    def test_alive_whatever_happens(self, gone: AppClient) -> None:
        assert gone.get("/livez").json() == {"status": "alive"}

    def test_ready_with_a_worker(self, client: AppClient, store: Store) -> None:
        assert client.get("/readyz").status_code == 503
        assert "no worker" in client.get("/readyz").json()["detail"]
        store.queue.announce({"name": "a"}, ttl=60)
        assert client.get("/readyz").json() == {"status": "ready", "workers": 1, "waiting": 0}
        store.queue.retire("a")
        assert client.get("/readyz").status_code == 503

    def test_not_ready_without_the_store(self, gone: AppClient) -> None:
        reply = gone.get("/readyz")
        assert reply.status_code == 503
        assert "queue server is away" in reply.json()["detail"]

    def test_a_store_that_is_away_is_503_everywhere(self, gone: AppClient) -> None:
        job = f"/v1/jobs/{'0' * 32}"
        calls = [("GET", "/v1/jobs"), ("GET", job), ("GET", f"{job}/events"), ("DELETE", job),
                 ("POST", f"{job}/cancel"), ("GET", "/v1/backends")]  # fmt: skip
        replies = [gone.request(*call) for call in calls]
        replies.append(gone.post("/v1/jobs", json=examples.load("cart_pole")))
        for reply in replies:
            assert reply.status_code == 503
            assert reply.json()["type"] == "/problems/store-unavailable"
            assert int(reply.headers["retry-after"]) >= 1


class TestMetrics:
    def test_templates_and_states_never_names(
        self, client: AppClient, hand: Hand, store: Store
    ) -> None:
        problem = examples.load("block_min_force") | {"name": "SECRET"}
        job = client.post("/v1/jobs", json=problem).json()
        client.get(job["links"]["self"])
        client.get("/nowhere/SECRET")
        client.request("BREW", "/v1/jobs")
        hand.start(job["id"])
        store.queue.announce({"name": "SECRET"}, ttl=60)
        page = client.get("/metrics").text
        route = 'footfall_requests_total{method="GET",route="/v1/jobs/{job_id}",status="200"} 1.0'
        assert route in page
        assert 'footfall_jobs{status="running"} 1.0' in page
        assert "footfall_jobs_accepted_total 1.0" in page
        assert "footfall_workers 1.0" in page
        assert "SECRET" not in page
        assert job["id"] not in page
        assert "BREW" not in page

    def test_without_the_store_there_are_still_metrics(self, gone: AppClient) -> None:
        gone.get("/livez")
        page = gone.get("/metrics").text
        assert "footfall_store_up 0.0" in page
        assert "footfall_requests_total" in page


class TestLog:
    def test_one_line_a_request(self, client: AppClient, caplog: pytest.LogCaptureFixture) -> None:
        with caplog.at_level(logging.INFO, "footfall.access"):
            client.get("/livez")
            client.get("/v1/jobs/%0aFORGED%20line")
        lines = [record.getMessage() for record in caplog.records]
        assert len(lines) == 2
        assert " GET /livez 200 " in lines[0]
        assert "\n" not in lines[1]

    def test_a_bug_is_answered_and_logged_under_one_number(
        self,
        client: AppClient,
        store: Store,
        monkeypatch: pytest.MonkeyPatch,
        caplog: pytest.LogCaptureFixture,
    ) -> None:
        def bug(*_: object, **__: object) -> object:
            raise ZeroDivisionError("private")

        monkeypatch.setattr(type(store.jobs), "list", bug)
        reply = client.get("/v1/jobs")
        assert reply.status_code == 500
        assert reply.headers["content-type"] == "application/problem+json"
        assert "private" not in reply.text
        (record,) = [r for r in caplog.records if r.name == "footfall.api"]
        number = record.getMessage().split()[1]
        assert number in reply.json()["detail"]
        assert client.get("/livez").status_code == 200


@pytest.mark.parametrize("path", ["/", "/livez", "/nope", "/v1/jobs", "/metrics", "/openapi.json"])
def test_every_answer_has_the_security_headers(client: AppClient, path: str) -> None:
    headers = client.get(path).headers
    assert set(map(str.lower, SECURITY_HEADERS)) <= set(headers)


class TestMethodsOfHttp:
    def test_head_is_get_without_the_body(self, client: AppClient) -> None:
        head, get = client.request("HEAD", "/v1/limits"), client.get("/v1/limits")
        assert head.status_code == 200
        assert head.content == b""
        assert head.headers["content-length"] == get.headers["content-length"]

    def test_head_of_a_stream_does_not_wait(self, client: AppClient, hand: Hand) -> None:
        job = client.post("/v1/jobs", json=examples.load("block_min_force")).json()
        hand.solve(job["id"])
        assert client.request("HEAD", job["links"]["events"]).status_code == 200

    def test_a_wrong_method_lists_the_right_ones(self, client: AppClient) -> None:
        reply = client.request("PUT", f"/v1/jobs/{'0' * 32}")
        assert reply.status_code == 405
        assert reply.json()["type"] == "/problems/wrong-method"
        assert reply.headers["allow"] == "DELETE, GET, HEAD"
        assert client.request("PATCH", "/console/x").headers["allow"] == "GET"

    def test_an_unknown_path(self, client: AppClient) -> None:
        reply = client.get("/v2/jobs")
        assert reply.status_code == 404
        assert reply.json()["type"] == "/problems/no-route"
        assert client.get("/v1/jobs/").status_code == 404


class TestImport:
    def test_it_is_light(self) -> None:
        code = (
            "import time; start = time.perf_counter()\n"
            "import api.serve, api.__main__, sys\n"
            "print(time.perf_counter() - start, *{n.partition('.')[0] for n in sys.modules})"
        )

        def run() -> tuple[float, set[str]]:
            done = subprocess.run(
                [sys.executable, "-c", code], capture_output=True, text=True, check=True
            )
            seconds, *names = done.stdout.split()
            return float(seconds), set(names)

        seconds, names = min((run() for _ in range(3)), key=lambda pair: pair[0])
        assert not names & {"casadi", "matplotlib", "scipy", "solver", "worker"}
        assert seconds < 1.0


class TestSettings:
    def test_defaults_are_safe(self) -> None:
        settings = from_environment({})
        assert settings == ApiSettings()
        assert settings.checked().loopback

    def test_everything_can_be_set(self) -> None:
        settings = from_environment(
            {
                "FOOTFALL_HOST": "0.0.0.0",  # noqa: S104 - it is what the guard is about
                "FOOTFALL_PORT": "80",
                "FOOTFALL_KEYS": "ann:0123456789abcdef, bob:fedcba9876543210",
                "FOOTFALL_BODY_BYTES": "1000",
                "FOOTFALL_MAX_SECONDS": "1.5",
                "FOOTFALL_MAX_MEGABYTES": "512",
                "FOOTFALL_MAX_WAITING_JOBS": "3",
                "FOOTFALL_MAX_SAMPLES": "10",
                "REDIS_URL": "redis://queue:6379/0",
            }
        )
        assert settings.checked().keys["0123456789abcdef"] == "ann"
        assert (settings.port, settings.body_bytes, settings.max_seconds) == (80, 1000, 1.5)
        assert "0123456789abcdef" not in repr(settings)

    @pytest.mark.parametrize(
        ("name", "value"),
        [
            ("FOOTFALL_PORT", "x"),
            ("FOOTFALL_PORT", "0"),
            ("FOOTFALL_PORT", "65536"),
            ("FOOTFALL_MAX_SECONDS", "nan"),
            ("FOOTFALL_MAX_MEGABYTES", "255"),
            ("FOOTFALL_OPEN", "maybe"),
            ("FOOTFALL_KEYS", "ann"),
            ("FOOTFALL_KEYS", "ann:short"),
            ("FOOTFALL_KEYS", "a b:0123456789abcdef"),
        ],
    )
    def test_a_malformed_setting_is_named(self, name: str, value: str) -> None:
        with pytest.raises(SettingsError, match=name):
            from_environment({name: value})

    @pytest.mark.parametrize("host", ["0.0.0.0", "::", "10.0.0.1", "footfall.example"])  # noqa: S104
    def test_others_are_not_served_by_accident(self, host: str, store: Store) -> None:
        with pytest.raises(SettingsError, match="FOOTFALL_OPEN"):
            serve(store, ApiSettings(host=host))
        for settings in (
            ApiSettings(host=host, open=True),
            ApiSettings(host=host, keys={"k": "a"}),
        ):
            assert settings.checked() is settings

    @pytest.mark.parametrize("host", ["127.0.0.1", "127.8.9.1", "::1", "localhost"])
    def test_this_machine_is_served(self, host: str) -> None:
        assert ApiSettings(host=host).checked().loopback

    @pytest.mark.parametrize(
        ("environment", "reason"),
        [
            ({}, "REDIS_URL"),
            ({"FOOTFALL_HOST": "10.0.0.1"}, "FOOTFALL_OPEN"),
            ({"FOOTFALL_PORT": "x"}, "FOOTFALL_PORT"),
        ],
    )
    def test_the_process_ends_with_2_and_a_reason(
        self, environment: dict[str, str], reason: str
    ) -> None:
        done = subprocess.run(
            [sys.executable, "-m", "api"],
            env={"PATH": "", **environment},
            capture_output=True,
            text=True,
            timeout=30,
            check=False,
        )
        assert done.returncode == 2
        assert reason in done.stderr
