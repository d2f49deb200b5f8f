"""A result's curves at times of the client's choice, as JSON, CSV or NPZ."""

import io
from dataclasses import dataclass
from typing import Any

import numpy as np
import orjson
from numpy.typing import NDArray
from pydantic import BaseModel, Field

from api.errors import BadParameter
from footfall.curves import Curves
from schemas.results import Group

JSON, CSV, NPZ = "application/json", "text/csv", "application/x-npz"
DEFAULT_SAMPLES = 201
MAX_VALUES = 5_000_000
"""Numbers in one answer, times included: about 100 MB of text."""

Floats = NDArray[np.float64]


class SampledPhase(BaseModel):
    """One phase; its groups look as they do in a result, at the times asked for."""

    name: str
    groups: dict[str, Group]


class Trajectory(BaseModel):
    """The answer in JSON. ``status`` is the solution's."""

    name: str
    status: str
    phases: list[SampledPhase] = Field(description="In their order in time.")


@dataclass(frozen=True, slots=True)
class Grid:
    """The times asked for: a number of them, or a distance in s. ``cap`` bounds their number."""

    samples: int | None
    dt: float | None
    cap: int

    def times(self, start: float, end: float) -> Floats:
        """Times from ``start`` to ``end``, both included. Raises BadParameter over the cap."""
        if self.dt is None:
            count = DEFAULT_SAMPLES if self.samples is None else self.samples
            self._check(count, "samples")
            return np.linspace(start, end, count)
        whole = (end - start) / self.dt * (1 + 1e-12)
        self._check(whole, "dt")
        times = start + self.dt * np.arange(int(whole) + 1)
        return np.append(times, end) if end - times[-1] > 1e-9 * self.dt else np.minimum(times, end)

    def _check(self, count: float, parameter: str) -> None:
        if count > self.cap:
            words = f"{count:.6g} times in one phase; at most {self.cap} are served"
            raise BadParameter(words, "Ask for fewer.", parameter)


@dataclass(frozen=True, slots=True)
class Samples:
    """Sampled series of one phase: their values at ``times`` by (group, name)."""

    phase: str
    times: Floats
    series: dict[tuple[str, str], Floats]


@dataclass(frozen=True, slots=True)
class Sampled:
    """A sampled result."""

    name: str
    status: str
    phases: list[Samples]


def sample(result: dict[str, Any], grid: Grid, fields: list[str] | None) -> Sampled:
    """Evaluate the curves of a result document.

    ``fields`` are names of series, names of groups, or ``group.name``; None takes every series.
    Raises BadParameter for a name that no phase has, and for more than can be served.
    """
    phases = [_sample_phase(phase, grid, fields) for phase in result["phases"]]
    known = {name for phase in result["phases"] for name in _known(phase)}
    missing = [name for name in fields or [] if name not in known]
    if missing:
        plain = ", ".join(sorted(name for name in known if "." not in name))[:400]
        raise BadParameter(f"there is no '{missing[0][:80]}'", f"There are: {plain}.", "fields")
    return Sampled(result["name"], result["status"], phases)


def _sample_phase(phase: dict[str, Any], grid: Grid, fields: list[str] | None) -> Samples:
    wanted = None if fields is None else set(fields)
    groups = {group: Curves.from_dict(raw) for group, raw in phase["curves"].items()}
    chosen = [
        (group, name)
        for group, curves in groups.items()
        for name in curves
        if wanted is None or wanted & {name, group, f"{group}.{name}"}
    ]
    times = grid.times(phase["knots"][0], phase["knots"][-1])
    if len(times) * len(chosen) > MAX_VALUES:
        words = (
            f"{len(times)} times of {len(chosen)} series; at most {MAX_VALUES} values are served"
        )
        raise BadParameter(words, "Ask for fewer times or fields.", "fields")
    return Samples(phase["name"], times, {key: groups[key[0]][key[1]](times) for key in chosen})


def _known(phase: dict[str, Any]) -> list[str]:
    names = []
    for group, curves in phase["curves"].items():
        series = list(curves["coefficients"])
        names += [group, *series, *(f"{group}.{name}" for name in series)]
    return names


def encode(sampled: Sampled, media_type: str) -> bytes:
    """The document in one of the offered types."""
    return {JSON: _json, CSV: _csv, NPZ: _npz}[media_type](sampled)


def _json(sampled: Sampled) -> bytes:
    phases = []
    for phase in sampled.phases:
        groups: dict[str, dict[str, Any]] = {}
        for (group, name), values in phase.series.items():
            entry = groups.setdefault(group, {"time": phase.times, "values": {}})
            entry["values"][name] = values
        phases.append({"name": phase.phase, "groups": groups})
    document = {"name": sampled.name, "status": sampled.status, "phases": phases}
    return orjson.dumps(document, option=orjson.OPT_SERIALIZE_NUMPY)


def _csv(sampled: Sampled) -> bytes:
    """One row a time; a series is headed by its name, with its group's where two share one."""
    keys = list(dict.fromkeys(key for phase in sampled.phases for key in phase.series))
    names = [name for _, name in keys]
    heads = [name if names.count(name) == 1 else f"{group}.{name}" for group, name in keys]
    lines = [",".join(["phase", "time", *heads])]
    for phase in sampled.phases:
        columns = [phase.times, *(phase.series.get(key) for key in keys)]
        cells = [_cells(column, len(phase.times)) for column in columns]
        lines += [f"{phase.phase},{','.join(row)}" for row in zip(*cells, strict=True)]
    return ("\n".join(lines) + "\n").encode()


def _cells(column: Floats | None, rows: int) -> list[str]:
    """Numbers that read back as they were; a series the phase does not have stays empty."""
    return [""] * rows if column is None else [repr(value) for value in column.tolist()]


def _npz(sampled: Sampled) -> bytes:
    """Arrays named ``phase/time`` and ``phase/group/name``."""
    arrays = {f"{phase.phase}/time": phase.times for phase in sampled.phases}
    for phase in sampled.phases:
        arrays |= {f"{phase.phase}/{group}/{name}": v for (group, name), v in phase.series.items()}
    buffer = io.BytesIO()
    np.savez_compressed(buffer, allow_pickle=False, **arrays)
    return buffer.getvalue()
