"""Keys and owners: what one owner may see of another is nothing."""

from collections.abc import Iterator

import pytest
from fastapi import FastAPI

import examples
from api.app import create_app
from api.settings import ApiSettings
from store.ports import Store
from tests.support.asgi import AppClient, app_client

KEYS = {"key-of-ann-0123456789": "ann", "key-of-bob-0123456789": "bob"}


def bearer(key: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {key}"}


ANN, BOB = (bearer(key) for key in KEYS)


@pytest.fixture
def settings() -> ApiSettings:
    return ApiSettings(keys=KEYS)


def post(client: AppClient, headers: dict[str, str]) -> str:
    reply = client.post("/v1/jobs", json=examples.load("block_min_force"), headers=headers)
    assert reply.status_code == 202
    return f"/v1/jobs/{reply.json()['id']}"


@pytest.mark.parametrize(
    "headers",
    [{}, bearer("wrong"), bearer(""), {"Authorization": "Basic YTpi"}, bearer("\u00e9\u00e9")],
)
def test_without_a_known_key_nothing_is_told(client: AppClient, headers: dict[str, str]) -> None:
    raw = {name: value.encode() for name, value in headers.items()}
    for path in ("/v1/jobs", f"/v1/jobs/{'0' * 32}", "/v1/examples", "/v1/backends"):
        reply = client.get(path, headers=raw)
        assert reply.status_code == 401
        assert reply.json()["type"] == "/problems/unauthorized"
        assert reply.headers["www-authenticate"].startswith("Bearer")


def test_health_and_console_need_no_key(client: AppClient) -> None:
    for path in ("/", "/livez", "/metrics", "/openapi.json", "/problems/unauthorized"):
        assert client.get(path).status_code == 200


def test_a_foreign_job_is_as_unknown_as_none(client: AppClient) -> None:
    url = post(client, ANN)
    unknown = client.get(f"/v1/jobs/{'0' * 32}", headers=BOB)
    for method, path in [
        ("GET", ""), ("GET", "/result"), ("GET", "/trajectory"), ("GET", "/events"),
        ("GET", "/report.html"), ("POST", "/cancel"), ("DELETE", ""),
    ]:  # fmt: skip
        reply = client.request(method, url + path, headers=BOB)
        assert reply.status_code == unknown.status_code == 404
        assert reply.json()["type"] == unknown.json()["type"]
    assert client.get(url, headers=ANN).json()["status"] == "queued"


def test_lists_and_idempotency_keys_are_ones_own(client: AppClient) -> None:
    first = post(client, ANN | {"Idempotency-Key": "k"})
    second = post(client, BOB | {"Idempotency-Key": "k"})
    assert first != second
    jobs = client.get("/v1/jobs", headers=BOB).json()["jobs"]
    assert [job["links"]["self"] for job in jobs] == [second]


def test_without_keys_there_is_one_owner(store: Store) -> None:
    with app_client(create_app(store, ApiSettings())) as client:
        url = post(client, {})
        assert store.jobs.get(url.rsplit("/", 1)[1]).owner == "local"
        assert client.get(url, headers=bearer("anything")).status_code == 200


class TestHosts:
    @pytest.fixture
    def settings(self) -> ApiSettings:
        return ApiSettings(hosts=frozenset({"127.0.0.1", "localhost", "::1"}))

    @pytest.fixture
    def client(self, app: FastAPI) -> Iterator[AppClient]:
        with app_client(app) as client:
            yield client

    @pytest.mark.parametrize("host", ["localhost", "127.0.0.1:8000", "[::1]:80", "LOCALHOST:1"])
    def test_names_of_this_machine_are_served(self, client: AppClient, host: str) -> None:
        assert client.get("/livez", headers={"Host": host}).status_code == 200

    @pytest.mark.parametrize(
        "host", ["rebound.example", "localhost.evil.example:8000", "", "[::2]"]
    )
    def test_other_names_are_not(self, client: AppClient, host: str) -> None:
        reply = client.get("/livez", headers={"Host": host})
        assert reply.status_code == 421
        assert reply.json()["type"] == "/problems/wrong-host"
