"""What users see of a phase that was stepped through contact: forces and impulses of each step."""

from collections.abc import Mapping, Sequence

import numpy as np

from schemas.mechanisms import Mechanism
from schemas.results import CurveGroup, Group, PhaseResult
from schemas.systems import System
from schemas.urdf import Urdf
from solver.contact.names import ContactNames, LimitNames, SpaceNames
from solver.contact.space import around
from solver.lowering import STRETCH
from solver.numeric.tape import Array

_Rows = Mapping[str, Array]


def published(system: System, result: PhaseResult) -> PhaseResult:
    """The result without slacks: controls, forces and impulses, one value a step.

    ``system`` is the one with forces as controls. States keep their values at the knots.
    """
    inner = result.groups["controls"].values
    raw = {
        name: np.array([np.nan if one is None else one for one in row], dtype=float)[:-1]
        for name, row in inner.items()
    }
    forces, hidden = _forces(system, raw), _hidden(system)
    own = {name: raw[name] for name in system.control_names if name not in hidden}
    result = _timed(result)
    ends, lengths = result.knots[1:], np.diff(result.knots)
    impulses = {name: row * lengths for name, row in forces.items()}
    groups = {
        "states": result.groups["states"],
        "controls": _group(ends, own),
        "forces": _group(ends, forces),
        "impulses": _group(ends, impulses),
    }
    curves = {
        "states": result.curves["states"],
        "controls": _steps(result.knots, own),
        "forces": _steps(result.knots, forces),
    }
    seen = {name: value for name, value in result.integrals.items() if not name.startswith("#")}
    return result.model_copy(update={"groups": groups, "curves": curves, "integrals": seen})


def _timed(result: PhaseResult) -> PhaseResult:
    """With the times that steps of their own lengths really have."""
    states, curves = result.groups["states"], result.curves["states"]
    if STRETCH not in states.values:
        return result
    stretch = np.array(states.values[STRETCH][1:], dtype=float)
    lengths = np.diff(result.knots) * stretch
    knots = [result.knots[0], *(result.knots[0] + np.cumsum(lengths)).tolist()]
    kept = {name: row for name, row in states.values.items() if name != STRETCH}
    lines = {name: row for name, row in curves.coefficients.items() if name != STRETCH}
    groups = {**result.groups, "states": Group(time=knots, values=kept)}
    moved = {**result.curves, "states": CurveGroup(breaks=knots, coefficients=lines)}
    return result.model_copy(update={"knots": knots, "groups": groups, "curves": moved})


def _hidden(system: System) -> list[str]:
    """Controls that are none of the user's."""
    if isinstance(system, Mechanism):
        return list(system.loose)
    names = system.controls if isinstance(system, Urdf) else ()
    return [name for name in names if "." in name]  # no user can write a dot there


def _forces(system: System, raw: _Rows) -> dict[str, Array]:
    if isinstance(system, Mechanism):
        return _planar(system, raw)
    return _spatial(system, raw) if isinstance(system, Urdf) else {}


def _spatial(system: Urdf, raw: _Rows) -> dict[str, Array]:
    found: dict[str, Array] = {}
    for name in system.touching:
        names = SpaceNames(name)
        pushes = np.array([raw[one] for one in names.pushes(system.controls)])
        found[names.normal] = raw[names.normal]
        x, y = np.transpose(around(len(pushes))) @ pushes
        found |= dict(zip(names.tangential, (x, y), strict=True))
    return found | _stops(
        [name for name in system.coordinates if _stop(name) in system.define], raw
    )


def _stop(joint: str) -> str:
    return LimitNames(joint).effort


def _stops(joints: Sequence[str], raw: _Rows) -> dict[str, Array]:
    """What the stops of joints do, the lower one less the upper one."""
    none = np.zeros(1)
    names = [LimitNames(joint) for joint in joints]
    return {one.effort: raw.get(one.lower, none) - raw.get(one.upper, none) for one in names}


def _planar(system: Mechanism, raw: _Rows) -> dict[str, Array]:
    found: dict[str, Array] = {}
    for pair in system.touching:
        names = ContactNames(pair)
        found[names.normal] = raw[names.normal]
        found[names.tangential] = raw[names.right] - raw[names.left]
    found |= _stops([joint for joint in system.joints if _stop(joint) in system.torques], raw)
    for loop in system.loops:
        found |= {f"loop.{loop}.{word}": raw[f"loop.{loop}.{word}"] for word in ("x", "y")}
    return found


def _group(times: Sequence[float], rows: _Rows) -> Group:
    values = {
        name: [float(one) if np.isfinite(one) else None for one in row]
        for name, row in rows.items()
    }
    return Group(time=list(times), values=values)


def _steps(knots: Sequence[float], rows: _Rows) -> CurveGroup:
    """Constant on each step."""
    coefficients = {
        name: [[float(one) if np.isfinite(one) else None] for one in row]
        for name, row in rows.items()
    }
    return CurveGroup(breaks=list(knots), coefficients=coefficients)
