"""Steps through contact, published as contact-implicit phases are."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from schemas.problem import Problem
from schemas.reading import read_problem
from schemas.results import Certificate, Check, Group, PhaseResult

Array = NDArray[np.float64]


def problem(system: Mapping[str, Any], duration: float, **changes: Any) -> Problem:
    """A problem of one phase of steps; ``method`` has further settings of these."""
    method = {"kind": "contact_implicit", **changes.pop("method", {})}
    top = {key: changes.pop(key) for key in list(changes) if key in Problem.model_fields}
    phase = {"name": "move", "system": system, "time": {"final": duration}, **changes}
    return read_problem({"phases": [phase], "method": method, **top})


def published(
    knots: Array,
    states: Mapping[str, Array],
    controls: Mapping[str, Array],
    forces: Mapping[str, Array],
) -> PhaseResult:
    """Coordinates at the knots (N + 1,), the start's velocities ``d(q)`` (1,), the rest (N,)."""
    own = {name: values for name, values in states.items() if not name.endswith(")")}
    chords = {name: np.diff(values) / np.diff(knots) for name, values in own.items()}
    rates = {rate(name): np.concatenate([states[rate(name)], chords[name]]) for name in own}
    steps = np.diff(knots)
    impulses = {name: values * steps for name, values in forces.items()}
    groups = {
        "states": group(knots, {**own, **rates}),
        "controls": group(knots[1:], controls),
        "forces": group(knots[1:], forces),
        "impulses": group(knots[1:], impulses),
    }
    return PhaseResult(name="move", knots=knots.tolist(), groups=groups, curves={})


def rate(name: str) -> str:
    """``d(x)`` of ``x``, ``BODY.d(x)`` of ``BODY.x``."""
    head, dot, tail = name.rpartition(".")
    return f"{head}{dot}d({tail})"


def group(time: Array, values: Mapping[str, Array]) -> Group:
    """Series as a result has them."""
    return Group(time=time.tolist(), values={name: one.tolist() for name, one in values.items()})


def row(certificate: Certificate, name: str) -> Check:
    """The check of a name."""
    return next(check for check in certificate.checks if check.name == name)
