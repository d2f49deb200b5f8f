"""What is simulated, made ready; and what a method gives back."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from schemas import resolve
from schemas.errors import InvalidModel, Issue
from schemas.expressions import ExpressionError
from schemas.simulated import ModeSpan, SimulationEvent, SimulationStatus
from schemas.simulations import Simulation, SolutionSignal
from schemas.systems import System
from schemas.urdf import Urdf
from solver.numeric.tape import Array
from solver.simulation.drive import Drive, circular
from solver.simulation.inertias import check_inertias
from solver.simulation.multibody import Multibody
from solver.simulation.plant import MechanismPlant, Plant, plant_of
from solver.simulation.spatial import SpatialMultibody
from solver.simulation.spatial_plant import SpatialPlant

Halt = Callable[[float, int], tuple[SimulationStatus, str] | None]
"""Asked once a step, of the time of the motion and the events so far: a reason to end."""


@dataclass(frozen=True, slots=True)
class Experiment:
    """A system, what drives it, where it starts, and for how long it goes."""

    simulation: Simulation
    plant: Plant
    drive: Drive
    state: Array
    start: float
    end: float
    statics: Mapping[str, float]

    @classmethod
    def of(cls, simulation: Simulation) -> "Experiment":
        """Read a simulation.

        Raises
        ------
        InvalidModel
            For names without value, and constants that cannot be evaluated.
        """
        system = simulation.system
        try:
            statics = _statics(simulation)
            known = {**statics, **resolve.parameters(system)}
            plant = plant_of(system, statics)
            start = resolve.scalar(simulation.start, known)
            duration = resolve.scalar(simulation.duration, known)
            given = {name: resolve.scalar(one, known) for name, one in simulation.initial.items()}
        except ExpressionError as error:
            raise InvalidModel([Issue("/system", error.message, error.hint)]) from None
        given = _upright(system) | given
        state = np.array([given.get(name, 0.0) for name in plant.states])
        issue = circular(simulation, plant, np.array([start]), state[:, None])
        _refuse([issue] if issue is not None else [])
        if isinstance(plant, MechanismPlant):
            _refuse(check_inertias(plant.model, state[: len(state) // 2]))
        drive = Drive.of(simulation, plant)
        return cls(simulation, plant, drive, state, start, start + duration, statics)

    def rates(self, t: float, x: Array, within: float) -> Array:
        """dx/dt (states,) under the drive, of one state (states,); ``within`` as for `Drive`."""
        time, state = np.array([t]), x[:, None]
        return self.plant.rates(time, state, self.drive(time, state, within))[:, 0]

    @property
    def model(self) -> Multibody | SpatialMultibody | None:
        """The bodies, where the system has any."""
        return self.plant.model if isinstance(self.plant, MechanismPlant | SpatialPlant) else None

    @property
    def mechanism(self) -> MechanismPlant | None:
        """The plant, where it is a mechanism."""
        return self.plant if isinstance(self.plant, MechanismPlant) else None


def _refuse(issues: Iterable[Issue]) -> None:
    found = list(issues)
    if found:
        raise InvalidModel(found)


def _upright(system: System) -> dict[str, float]:
    """The quaternions of a URDF system, where they are left out: no turn."""
    return dict.fromkeys(system.balls, 1.0) if isinstance(system, Urdf) else {}


def _statics(simulation: Simulation) -> dict[str, float]:
    """The posted values, over those of the solution that is played."""
    played = simulation.controls.static if isinstance(simulation.controls, SolutionSignal) else {}
    values = {**played}
    for name, value in simulation.static.items():
        values[name] = resolve.scalar(value, {})
    return values


@dataclass(frozen=True, slots=True)
class Stretch:
    """A part of the motion without a jump.

    Attributes
    ----------
    times
        Of the steps, both ends included, (steps + 1,).
    states
        Of times (k,) within one step, whose number is given, to states (states, k).
    mode
        Whatever a method knows its modes by.
    """

    times: Array
    states: Callable[[int, Array], Array]
    mode: Any = None


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a motion went.

    Attributes
    ----------
    degree
        Of the polynomials that the steps are, for the published curves.
    forces
        Of a stretch and times (k,), states and controls (names, k) in it: more series by name,
        the forces of contacts and loops.
    """

    stretches: Sequence[Stretch]
    status: SimulationStatus = SimulationStatus.FINISHED
    message: str = ""
    events: Sequence[SimulationEvent] = ()
    modes: Sequence[ModeSpan] = ()
    degree: int = 7
    forces: Callable[[Stretch, Array, Array, Array], Mapping[str, Array]] | None = None
    evaluations: int = 0
    steps: int = 0
    advice: Sequence[str] = field(default_factory=list)
