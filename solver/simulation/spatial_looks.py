"""The names of a URDF system as values at N points: for the judge and for forces."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Protocol

from schemas.expressions import derivative
from schemas.urdf import Urdf, motor_torque
from solver.numeric.tape import Array
from solver.simulation.spatial_kinematics import Frame


class Looked(Protocol):
    """What is looked at: an instant (`solver.simulation.spatial_instant`)."""

    @property
    def t(self) -> Array:
        """Times (N,), beside q, v and u."""

    @property
    def system(self) -> Urdf:
        """What is moving."""

    @property
    def controls(self) -> Sequence[str]:
        """Names of u."""

    @property
    def mass_total(self) -> float:
        """Mass, kg."""

    @property
    def frames(self) -> Mapping[str, Frame]:
        """Of links."""

    @property
    def centres(self) -> Mapping[str, Frame]:
        """Of contacts."""

    def gap(self, name: str) -> Array:
        """Of a contact, (N,)."""

    def slip(self, name: str) -> Array:
        """Of a contact, (N, 2)."""

    @property
    def com(self) -> Array:
        """(N, 3), as the momenta are."""

    @property
    def momentum(self) -> Array:
        """N s."""

    @property
    def angular(self) -> Array:
        """N m s."""

    @property
    def kinetic(self) -> Array:
        """J, (N,)."""

    @property
    def potential(self) -> Array:
        """J, (N,)."""


Look = Callable[[Looked], Array]
"""From an instant to the values of a name, (N,)."""
_Where = Callable[[Looked], Frame]
_Vector = Callable[[Looked], Array]


def looks(at: Looked) -> dict[str, Look]:
    """Every name that needs no forces of contacts, by the system of an instant."""
    system = at.system
    found: dict[str, Look] = {"t": lambda one: one.t}
    for row, name in enumerate(system.coordinates):
        found[name] = partial(_row, group="q", row=row)
        found[derivative(name)] = partial(_row, group="v", row=row)
    for row, name in enumerate(at.controls):
        found[name] = partial(_row, group="u", row=row)
    for joint in system.motor_joints:
        rate, torque = found[derivative(joint)], found[motor_torque(joint)]
        found[f"motor.{joint}.speed"] = rate
        found[f"motor.{joint}.power"] = partial(_product, a=rate, b=torque)
    for link in system.tree.links:
        _add(found, link, partial(_frame, link=link))
    for name in system.contacts:
        _add_point(found, name, partial(_centre, contact=name))
        found[f"contact.{name}.gap"] = partial(_gap, contact=name)
        for index, axis in enumerate("xy"):
            found[f"contact.{name}.slip_{axis}"] = partial(_slip, contact=name, index=index)
    _add_whole(found)
    return found


def _add_whole(found: dict[str, Look]) -> None:
    vectors: dict[str, _Vector] = {
        "com.": lambda one: one.com,
        "com.v": lambda one: one.momentum / one.mass_total,
        "com.p": lambda one: one.momentum,
        "com.spin_": lambda one: one.angular,
    }
    for prefix, vector in vectors.items():
        for index, axis in enumerate("xyz"):
            found[f"{prefix}{axis}"] = partial(_entry, vector=vector, index=index)
    found["energy.kinetic"] = lambda one: one.kinetic
    found["energy.potential"] = lambda one: one.potential
    found["energy.total"] = lambda one: one.kinetic + one.potential


def _add_point(found: dict[str, Look], name: str, take: _Where) -> None:
    for index, axis in enumerate("xyz"):
        found[f"{name}.{axis}"] = partial(_of, take=take, what="place", index=index)
        for word in (f"{name}.v{axis}", derivative(f"{name}.{axis}")):
            found[word] = partial(_of, take=take, what="velocity", index=index)


def _add(found: dict[str, Look], link: str, take: _Where) -> None:
    _add_point(found, link, take)
    for index, axis in enumerate("xyz"):
        found[f"{link}.w{axis}"] = partial(_of, take=take, what="spin", index=index)
        for column in range(3):
            look = partial(_turn, take=take, row=index, column=column)
            found[f"{link}.r{index + 1}{column + 1}"] = look


def _row(at: Looked, group: str, row: int) -> Array:
    values: Array = getattr(at, group)[row]
    return values


def _product(at: Looked, a: Look, b: Look) -> Array:
    return a(at) * b(at)


def _frame(at: Looked, link: str) -> Frame:
    return at.frames[link]


def _centre(at: Looked, contact: str) -> Frame:
    return at.centres[contact]


def _gap(at: Looked, contact: str) -> Array:
    return at.gap(contact)


def _slip(at: Looked, contact: str, index: int) -> Array:
    return at.slip(contact)[:, index]


def _entry(at: Looked, vector: _Vector, index: int) -> Array:
    return vector(at)[:, index]


def _of(at: Looked, take: _Where, what: str, index: int) -> Array:
    values: Array = getattr(take(at), what)[:, index]
    return values


def _turn(at: Looked, take: _Where, row: int, column: int) -> Array:
    return take(at).axes[:, row, column]
