"""The whole gallery through one service with two workers, as a visitor would try it."""

import json
from collections.abc import Callable, Iterator
from html import escape
from typing import Any

import pytest

from footfall import Client, Job, Result
from footfall.cli import codes
from footfall.serving import ServeSettings, Service

pytestmark = [pytest.mark.slow, pytest.mark.timeout(1200)]  # the first test waits for all of it


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
    """Name -> job and result of every problem: all are queued first, then waited for."""
    return ended(client, "problem", client.submit)


@pytest.fixture(scope="module")
def simulated(client: Client) -> dict[str, tuple[str, Result]]:
    """The same of every simulation."""
    return ended(client, "simulation", client.simulate)


def ended(
    client: Client, kind: str, post: Callable[[dict[str, Any]], Job]
) -> dict[str, tuple[str, Result]]:
    names = [one["name"] for one in client.examples() if one["kind"] == kind]
    jobs = {name: post(client.example(name)).id for name in names}
    return {name: (job, client.wait(job, timeout=300)) for name, job in jobs.items()}


def test_every_example_converges_with_a_certificate(
    results: dict[str, tuple[str, Result]],
) -> None:
    ends = {
        name: (found.status, found.certificate["verdict"]) for name, (_, found) in results.items()
    }
    assert ends == dict.fromkeys(ends, ("converged", "certified"))
    assert {codes.of_status(found.status) for _, found in results.values()} == {codes.CONVERGED}


def test_every_simulation_comes_to_an_end_of_its_own(
    simulated: dict[str, tuple[str, Result]],
) -> None:
    ends = {name: found.status for name, (_, found) in simulated.items()}
    assert ends
    assert not {"diverged", "time_limit", "cancelled", "invalid_number"} & set(ends.values()), ends


def test_every_result_is_json_and_has_a_report(
    client: Client,
    results: dict[str, tuple[str, Result]],
    simulated: dict[str, tuple[str, Result]],
) -> None:
    for name, (job, found) in {**results, **simulated}.items():
        assert len(json.dumps(found.document, allow_nan=False)) < 6_000_000, name
        page = client.report(job)
        assert escape(found.name) in page, name
        assert "NaN" not in page, name
        assert len(page) < 2_000_000, name
        bodies = any(phase["frames"] for phase in found.document["phases"])
        assert ('id="motion"' in page) == bodies, name
