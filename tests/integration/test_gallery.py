"""The whole gallery through one service with two workers, as a visitor would try it."""

import json
from collections.abc import Iterator
from html import escape

import pytest

from footfall import Client, Result
from footfall.cli import codes
from footfall.serving import ServeSettings, Service

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    folder = tmp_path_factory.mktemp("gallery")
    with (
        Service(ServeSettings(port=0, workers=2, folder=folder)) as service,
        Client(service.url) as opened,
    ):
        yield opened


@pytest.fixture(scope="module")
def results(client: Client) -> dict[str, tuple[str, Result]]:
    """Name -> job and result of every example: all are queued first, then waited for."""
    jobs = {one["name"]: client.submit(client.example(one["name"])).id for one in client.examples()}
    return {name: (job, client.wait(job, timeout=100)) for name, job in jobs.items()}


def test_every_example_converges_with_a_certificate(
    results: dict[str, tuple[str, Result]],
) -> None:
    ends = {
        name: (found.status, found.certificate["verdict"]) for name, (_, found) in results.items()
    }
    assert ends == dict.fromkeys(ends, ("converged", "certified"))
    assert {codes.of_status(found.status) for _, found in results.values()} == {codes.CONVERGED}


def test_every_result_is_json_and_has_a_report(
    client: Client, results: dict[str, tuple[str, Result]]
) -> None:
    for name, (job, found) in results.items():
        assert len(json.dumps(found.document, allow_nan=False)) < 6_000_000, name
        page = client.report(job)
        assert escape(found.name) in page, name
        assert "NaN" not in page, name
        assert len(page) < 2_000_000, name
