"""The names that a mechanism brings along, as numbers (``schemas.mechanisms.names``)."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from schemas.expressions import derivative
from schemas.mechanisms import Mechanism
from solver.numeric.tape import Array
from solver.simulation.constants import Constants
from solver.simulation.instant import Instant, Look, Parts
from solver.simulation.kinematics import Complex
from solver.simulation.loads import laws_of
from solver.simulation.scope import Vocabulary

Spot = Callable[[Instant], tuple[Complex, Complex]]
"""Gets position and velocity of a place, complex (N,) each."""


def named(mechanism: Mechanism, constants: Constants, more: Sequence[str] = ()) -> Parts:
    """The parts of a mechanism with names and the laws of the user; ``more`` are further controls.

    Raises
    ------
    InvalidModel
        Where a force depends on what is not known before the forces are.
    """
    bare = Parts.of(mechanism, constants)
    found = looks(mechanism, bare, more)
    early = {name for name in found if not _late(name)}
    definitions = {name: one.tree for name, one in mechanism.define.items()}
    words = Vocabulary(constants.values, definitions, early.__contains__)
    laws, inputs = words.record(laws_of(mechanism))
    return replace(bare, looks=found, laws=laws, law_inputs=inputs)


def _late(name: str) -> bool:
    """Whether a name rests on the springs' laws, which therefore cannot use it."""
    return name in ("energy.potential", "energy.total") or (
        name.startswith("spring.") and name.endswith(".force")
    )


def looks(mechanism: Mechanism, parts: Parts, more: Sequence[str] = ()) -> dict[str, Look]:
    """Every name that follows from coordinates, velocities and controls, and how to get it.

    First derivatives too, of places, lengths and gaps; forces of contacts and loops are not here.
    """
    return {
        "t": lambda at: at.t,
        **_places(parts),
        **_of_contacts(parts),
        **_of_springs(parts),
        **_of_motors(parts),
        **_of_the_whole(),
        **_rows("", parts.axes.names, lambda at: at.joints[0]),
        **_rows("", map(derivative, parts.axes.names), lambda at: at.joints[1]),
        **_rows("", mechanism.coordinates, lambda at: at.q),
        **_rows("", map(derivative, mechanism.coordinates), lambda at: at.v),
        **_rows("", [*mechanism.control_names, *more], lambda at: at.u),
    }


def _rows(word: str, owners: Iterable[str], table: Look) -> dict[str, Look]:
    """One row of a table for each owner; ``word`` is put in the place of its name."""

    def look(row: int, at: Instant) -> Array:
        return np.asarray(table(at)[row])

    return {word.format(name) or name: partial(look, row) for row, name in enumerate(owners)}


def _places(parts: Parts) -> dict[str, Look]:
    found: dict[str, Look] = {}
    for name, row in parts.spots.items():
        found |= _of_point(name, partial(_spot, row))
    bodies = parts.kinematics.bodies
    return {
        **found,
        **_rows("{}.angle", bodies, lambda at: at.pose.angles[1:]),
        **_rows("{}.omega", bodies, lambda at: at.pose.spins[1:]),
        **_rows("{}.d(angle)", bodies, lambda at: at.pose.spins[1:]),
    }


def _of_point(name: str, spot: Spot) -> dict[str, Look]:
    words: Mapping[str, Look] = {
        "x": lambda at: spot(at)[0].real,
        "y": lambda at: spot(at)[0].imag,
        "vx": lambda at: spot(at)[1].real,
        "vy": lambda at: spot(at)[1].imag,
    }
    rates = {"d(x)": words["vx"], "d(y)": words["vy"]}
    return {f"{name}.{word}": look for word, look in {**words, **rates}.items()}


def _spot(row: Complex, at: Instant) -> tuple[Complex, Complex]:
    return row @ at.pose.features, row @ at.pose.rates


def _of_contacts(parts: Parts) -> dict[str, Look]:
    names = parts.touch.names
    return {
        **_rows("contact.{}.gap", names, lambda at: at.contacts.gaps),
        **_rows("contact.{}.d(gap)", names, lambda at: at.contacts.gap_rates),
        **_rows("contact.{}.slip", names, lambda at: at.contacts.slips),
    }


def _of_springs(parts: Parts) -> dict[str, Look]:
    names = parts.springs.names
    return {
        **_rows("spring.{}.length", names, lambda at: at.stretch.length),
        **_rows("spring.{}.d(length)", names, lambda at: at.stretch.rate),
        **_rows("spring.{}.force", names, lambda at: at.tensions),
    }


def _of_motors(parts: Parts) -> dict[str, Look]:
    axes = [drive.axis for drive in parts.drives.values()]
    return {
        **_rows("motor.{}.torque", parts.drives, lambda at: at.motors),
        **_rows("motor.{}.speed", parts.drives, lambda at: at.joints[1][axes]),
        **_rows("motor.{}.power", parts.drives, lambda at: at.powers),
    }


def _of_the_whole() -> dict[str, Look]:
    def com(at: Instant) -> tuple[Complex, Complex]:
        total = at.parts.masses.sum()
        return at.parts.masses @ at.coms.z / total, at.momentum / total

    return {
        **_of_point("com", com),
        "com.px": lambda at: at.momentum.real,
        "com.py": lambda at: at.momentum.imag,
        "com.spin": lambda at: at.spin,
        "energy.kinetic": lambda at: at.kinetic,
        "energy.potential": lambda at: at.potential,
        "energy.total": lambda at: at.kinetic + at.potential,
    }
