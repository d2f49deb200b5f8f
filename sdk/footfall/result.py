"""A result with its trajectories as numpy arrays and as continuous curves."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footfall.curves import Curve, Curves, Floats
from footfall.documents import read_json
from footfall.errors import BadFile
from footfall.modes import ModeSequence
from footfall.simulated import summarize_simulation
from footfall.summary import summarize


@dataclass(frozen=True)
class NodeValues:
    """The values at the nodes of the transcription: one group of a phase.

    ``time`` has shape (nodes,), in s; ``values`` maps a name to an array of the same shape, NaN
    where the solver left no number.
    """

    time: Floats
    values: dict[str, Floats]


class PhaseResult(Mapping[str, Curve]):
    """One phase of a result: ``phase["q1"](t)`` is the value of q1 at the times t.

    Values between the nodes come from the method's own interpolant. States are looked up before
    controls and all else; ``phase.curves[group][name]`` says which is meant.
    """

    def __init__(self, document: Mapping[str, Any]) -> None:
        self.name: str = document["name"]
        self.knots: Floats = np.asarray(document["knots"], dtype=float)
        self.integrals: dict[str, float | None] = dict(document.get("integrals", {}))
        self.curves = {name: Curves.from_dict(g) for name, g in document["curves"].items()}
        self.nodes = {name: _node_values(g) for name, g in document["groups"].items()}
        self._flat = {
            name: curve for group in reversed(self.curves.values()) for name, curve in group.items()
        }

    @property
    def domain(self) -> tuple[float, float]:
        """The initial and the final time of the phase, in s."""
        return float(self.knots[0]), float(self.knots[-1])

    def sample(self, times: int | NDArray[Any] = 101) -> dict[str, Floats]:
        """Every series at ``times``: an array in s, or how many, evenly over the phase.

        The times themselves are under "time".
        """
        at = np.linspace(*self.domain, times) if isinstance(times, int) else np.asarray(times)
        return {"time": at, **{name: curve(at) for name, curve in self.items()}}

    def __getitem__(self, name: str) -> Curve:
        if name not in self._flat:
            known = ", ".join(self._flat)
            raise KeyError(f"the phase {self.name!r} has no series {name!r}; it has {known}")
        return self._flat[name]

    def __iter__(self) -> Iterator[str]:
        return iter(dict.fromkeys(name for group in self.curves.values() for name in group))

    def __len__(self) -> int:
        return len(self._flat)


class Result:
    """A finished solve: status, objective, trajectories, mesh history and certificate.

    ``result["q1"](t)`` evaluates a series of the only phase, ``result.phase["swing_up"]["q1"](t)``
    one of a named phase. ``document`` is the JSON as the service sent it.
    """

    needed = frozenset({"status", "phases", "certificate", "mesh_refinement"})
    """Fields without which a document is no such result."""

    def __init__(self, document: dict[str, Any]) -> None:
        self.document = document

    @staticmethod
    def load(path: str | Path) -> "Result":
        """Read a result that ``save`` or ``footfall result`` wrote. Raises ``BadFile``."""
        document = read_json(path)
        found = read_result(document)
        missing = found.needed - document.keys()
        if missing:
            hint = "A result comes from 'footfall solve --output' or 'footfall result'."
            raise BadFile(f"{path} holds no result: {', '.join(sorted(missing))} missing.", hint)
        return found

    def save(self, path: str | Path) -> None:
        """Write the result as JSON."""
        Path(path).write_text(json.dumps(self.document, allow_nan=False), encoding="utf-8")

    @property
    def name(self) -> str:
        """The problem's name."""
        return str(self.document.get("name", ""))

    @property
    def status(self) -> str:
        """How the mathematics ended, such as "converged" or "locally_infeasible"."""
        return str(self.document["status"])

    @property
    def converged(self) -> bool:
        """Whether the result is optimal, on a mesh that is fine enough, and certified."""
        return self.status == "converged"

    @property
    def objective(self) -> float | None:
        """The value that was minimized; None where the solver left no number."""
        value: float | None = self.document["objective"]
        return value

    @property
    def message(self) -> str:
        """The status in words."""
        return str(self.document["message"])

    @property
    def certificate(self) -> dict[str, Any]:
        """The independent judgement: verdict and checks, as in the JSON."""
        certificate: dict[str, Any] = self.document["certificate"]
        return certificate

    @property
    def mesh(self) -> list[dict[str, Any]]:
        """The meshes of the refinement, the last one that of the result."""
        iterations: list[dict[str, Any]] = self.document["mesh_refinement"]["iterations"]
        return iterations

    @cached_property
    def mode_sequence(self) -> ModeSequence | None:
        """Which contacts touched when, and how; None where the method tells no modes."""
        return self._sequence("mode_sequence")

    @cached_property
    def guessed_sequence(self) -> ModeSequence | None:
        """The same of the guess that a contact-implicit solve started from."""
        return self._sequence("guessed_sequence")

    def _sequence(self, field: str) -> ModeSequence | None:
        found = self.document.get(field)
        return ModeSequence.of(found) if found else None

    @cached_property
    def phases(self) -> list[PhaseResult]:
        """The phases in order of time."""
        return [PhaseResult(phase) for phase in self.document["phases"]]

    @property
    def phase(self) -> dict[str, PhaseResult]:
        """The phases by name."""
        return {phase.name: phase for phase in self.phases}

    def sample(self, times: int | NDArray[Any] = 101) -> dict[str, Floats]:
        """Every series of the only phase at ``times``, as ``PhaseResult.sample``."""
        return self._only().sample(times)

    def summary(self) -> str:
        """The result in a few lines of plain text."""
        return summarize(self.document)

    def __getitem__(self, name: str) -> Curve:
        return self._only()[name]

    def __repr__(self) -> str:
        return f"Result({self.name!r}, {self.status}, objective={self.objective})"

    def _only(self) -> PhaseResult:
        if len(self.phases) != 1:
            names = ", ".join(self.phase) or "none at all"
            raise KeyError(f"the result has not one phase but {names}; use result.phase[name]")
        return self.phases[0]


class SimulationResult(Result):
    """A finished simulation: trajectories as any result has them, and what happened on the way.

    It has no objective and no mesh, and nobody certifies it: nothing was optimized.
    """

    needed = frozenset({"status", "phases", "events"})

    @property
    def converged(self) -> bool:
        """Whether it went on to its end, or to an event that was to end it."""
        return self.status in ("finished", "stopped")

    @property
    def objective(self) -> float | None:
        """None: nothing was minimized."""
        return None

    @property
    def certificate(self) -> dict[str, Any]:
        """None was made."""
        return {"verdict": "not_checked", "checks": []}

    @property
    def mesh(self) -> list[dict[str, Any]]:
        """Empty: a simulation has steps, and no mesh."""
        return []

    @property
    def events(self) -> list[dict[str, Any]]:
        """Impacts, lift-offs and other events in their order, as in the JSON."""
        events: list[dict[str, Any]] = self.document["events"]
        return events

    def summary(self) -> str:
        """The result in a few lines of plain text."""
        return summarize_simulation(self.document)

    def __repr__(self) -> str:
        return f"SimulationResult({self.name!r}, {self.status}, {len(self.events)} events)"


def read_result(document: dict[str, Any]) -> Result:
    """The result in a document, of a solve or of a simulation."""
    simulated = document.get("kind") == "simulation"
    return SimulationResult(document) if simulated else Result(document)


def _node_values(group: Mapping[str, Any]) -> NodeValues:
    time = np.asarray(group["time"], dtype=float)
    return NodeValues(time, {n: np.array(v, dtype=float) for n, v in group["values"].items()})
