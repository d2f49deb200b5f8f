"""What the compose file and the Dockerfiles promise, read from them."""

import re
import tomllib
from typing import Any

import pytest

from tests.architecture.files import ROOT
from tests.support.containers import MissingVariable, compose, dockerfile

SECRETS = {"REDIS_PASSWORD": "a" * 48, "FOOTFALL_KEYS": "alice:" + "b" * 32}
SERVICES: dict[str, Any] = compose(SECRETS)["services"]
BUILT = [name for name, service in SERVICES.items() if "build" in service]


def seconds(duration: str) -> float:
    units = {"s": 1, "m": 60, "h": 3600}
    return sum(float(n) * units[unit] for n, unit in re.findall(r"([\d.]+)([smh])", duration))


def megabytes(size: str) -> float:
    return float(size[:-1]) * {"m": 1, "g": 1024}[size[-1]]


def test_the_services_are_api_worker_and_queue() -> None:
    assert set(SERVICES) == {"api", "worker", "queue"}


@pytest.mark.parametrize("name", SERVICES)
def test_a_service_is_confined_and_comes_back(name: str) -> None:
    service = SERVICES[name]
    assert service["restart"] == "unless-stopped"
    assert service["init"] is service["read_only"] is True
    assert service["cap_drop"] == ["ALL"]
    assert megabytes(service["mem_limit"]) > 0
    assert seconds(service["stop_grace_period"]) > 10
    assert "container_name" not in service, "a fixed name cannot be scaled"


@pytest.mark.parametrize("missing", SECRETS)
def test_a_missing_secret_stops_compose_with_a_reason(missing: str) -> None:
    with pytest.raises(MissingVariable, match=f"{missing}: copy .env.example to .env"):
        compose({name: value for name, value in SECRETS.items() if name != missing})


def test_the_example_of_secrets_names_every_variable() -> None:
    used = set(re.findall(r"\$\{(\w+)", (ROOT / "docker-compose.yml").read_text()))
    offered = set(re.findall(r"^(\w+)=", (ROOT / ".env.example").read_text(), re.MULTILINE))
    assert used == offered


def test_only_the_api_is_published_and_only_here() -> None:
    published = {name: service["ports"] for name, service in SERVICES.items() if "ports" in service}
    assert published == {"api": ["127.0.0.1:8000:8000"]}


def test_only_the_api_reaches_the_outside() -> None:
    networks = compose(SECRETS)["networks"]
    open_networks = {name for name, network in networks.items() if not network.get("internal")}
    reaching = {name for name, s in SERVICES.items() if open_networks & set(s["networks"])}
    assert reaching == {"api"}


def test_the_queue_keeps_what_it_was_given() -> None:
    command = SERVICES["queue"]["command"][-1]
    assert "--appendonly yes" in command
    assert "--maxmemory-policy noeviction" in command
    assert "--dir /data" in command
    assert SERVICES["queue"]["volumes"] == ["queue:/data"]


def test_the_queue_asks_for_the_password_and_no_list_of_processes_shows_it() -> None:
    command = SERVICES["queue"]["command"][-1]
    assert "requirepass $REDIS_PASSWORD" in command
    assert SECRETS["REDIS_PASSWORD"] not in command


@pytest.mark.parametrize("name", BUILT)
def test_api_and_worker_wait_for_a_healthy_queue(name: str) -> None:
    assert SERVICES[name]["depends_on"] == {"queue": {"condition": "service_healthy"}}
    assert SERVICES[name]["environment"]["REDIS_URL"] == f"redis://:{'a' * 48}@queue:6379/0"


def test_a_running_job_may_end_before_its_worker_is_killed() -> None:
    longest = float(SERVICES["api"]["environment"]["FOOTFALL_MAX_SECONDS"])
    assert seconds(SERVICES["worker"]["stop_grace_period"]) >= longest + 30


def test_a_worker_has_room_for_the_largest_job() -> None:
    largest = float(SERVICES["api"]["environment"]["FOOTFALL_MAX_MEGABYTES"])
    assert megabytes(SERVICES["worker"]["mem_limit"]) >= largest + 512


@pytest.mark.parametrize("name", BUILT)
def test_an_image_runs_its_room_unprivileged(name: str) -> None:
    image = dockerfile(SERVICES[name])
    assert image.all("USER") == ["footfall"]
    assert image.command == ["python", "-m", name]
    assert image.health[0] == "python"
    assert f".[{name}]" in image.all("RUN")[1]
    assert "-c requirements.lock" in image.all("RUN")[1]


@pytest.mark.parametrize("name", BUILT)
def test_an_image_copies_what_is_there_and_not_ignored(name: str) -> None:
    kept = re.findall(r"^!(\S+)$", (ROOT / ".dockerignore").read_text(), re.MULTILINE)
    for source in dockerfile(SERVICES[name]).copied:
        assert (ROOT / source).exists(), source
        assert source.rstrip("/") in kept, f".dockerignore hides {source}"


def test_the_image_of_the_api_has_no_engine() -> None:
    assert not {"solver/", "worker/"} & set(dockerfile(SERVICES["api"]).copied)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    installed = project["dependencies"] + project["optional-dependencies"]["api"]
    assert not [name for name in installed if re.match("casadi|scipy|matplotlib", name)]


def test_the_lock_file_has_versions_and_nothing_else() -> None:
    lines = (ROOT / "requirements.lock").read_text().splitlines()
    assert lines[0].startswith("#")
    assert all(re.fullmatch(r"[A-Za-z0-9._-]+==[A-Za-z0-9.+!]+", line) for line in lines[1:])
    assert lines[1:] == sorted(lines[1:], key=str.casefold)


def test_ci_installs_what_make_needs() -> None:
    script = (ROOT / ".ci/run").read_text()
    assert "make check" in script
    assert "make test" in script
