"""Schema, registry and documents name the same things; the engine names no robot."""

import re
from collections.abc import Iterable
from typing import get_args

from schemas.base import Posted
from schemas.methods import METHODS, SCHEDULES
from schemas.problem import SolverSettings
from schemas.simulations import SIMULATION_METHODS
from solver.backends import BACKENDS
from solver.simulation.simulate import METHODS as SIMULATED
from solver.transcriptions import TRANSCRIPTIONS
from tests.architecture.files import ROOT, modules, tracked


def kinds(*more: type[Posted], methods: Iterable[type[Posted]] = METHODS) -> set[str]:
    found = (*methods, *more)
    return {method.model_fields["kind"].annotation.__args__[0] for method in found}  # type: ignore[union-attr]


def test_every_method_of_the_schema_has_a_transcription() -> None:
    assert set(TRANSCRIPTIONS) == kinds()


def test_every_method_is_documented() -> None:
    text = "\n".join(path.read_text() for path in tracked() if path.parent == ROOT / "docs")
    assert not {kind for kind in kinds(*SCHEDULES) if f"`{kind}`" not in text}


def test_every_method_of_simulation_is_there_and_documented() -> None:
    named = kinds(methods=SIMULATION_METHODS)
    assert set(SIMULATED) == named
    text = (ROOT / "docs/simulation.md").read_text()
    assert not {kind for kind in named if f"`{kind}`: " not in text}


def test_every_backend_of_the_schema_is_there() -> None:
    named = get_args(SolverSettings.model_fields["backend"].annotation)
    assert set(named) == set(BACKENDS) == {backend.name for backend in BACKENDS.values()}


def test_the_engine_knows_no_robot() -> None:
    robots = re.compile(
        r"cart.?pole|pendulum|quadrotor|biped|flamingo|hopper|gripper|finger|bryson|robot",
        re.IGNORECASE,
    )
    named = [
        f"{path.relative_to(ROOT)}:{number} {line.strip()}"
        for path in modules("solver")
        for number, line in enumerate(path.read_text().splitlines(), 1)
        if robots.search(line)
    ]
    assert not named
