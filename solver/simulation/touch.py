"""Contacts: gaps, slips, the directions of their forces, and what they ask of accelerations."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from schemas.mechanisms import GROUND, Mechanism, Pair
from solver.numeric.tape import Array
from solver.simulation.constants import Constants
from solver.simulation.kinematics import Complex, Kinematics, Points, Pose
from solver.simulation.outlines import SERIES, Nearness, Outline


@dataclass(frozen=True, slots=True)
class Contacts:
    """All pairs at N points in time, in the order of the spec.

    Attributes
    ----------
    gaps, slips
        m and m/s, (pairs, N). The slip is the tangential velocity of the contact's material
        relative to that of the other side.
    gap_rates
        m/s.
    Jn, Jt
        d(gap)/dq and d(slip)/dv, (pairs, n, N). A tangential force acts along Jt.
    Gn
        What a normal force acts along, (pairs, n, N). It is Jn where the gap is zero, but for
        circles on what is curved: there the gap is a distance to first order, and its slope no
        unit vector.
    gap_bias, slip_bias
        dd(gap) and d(slip) at zero dd(q), (pairs, N).
    normals
        Unit vectors toward the contact's body, in the world, complex (pairs, N); tangents are
        these turned by -90 degrees.
    """

    gaps: Array
    slips: Array
    gap_rates: Array
    Jn: Array
    Jt: Array
    Gn: Array
    gap_bias: Array
    slip_bias: Array
    normals: Complex


@dataclass(frozen=True, slots=True)
class Touch:
    """The permitted pairs of a mechanism.

    Attributes
    ----------
    names
        Of the pairs.
    friction, restitution
        (pairs,).
    radii
        Of the contacts, (pairs,).
    bodies
        Of the contact and of what it touches, by number.
    places
        Both over the features, (pairs, features) each.
    outlines
        Each with the pairs that touch it.
    sloped
        Which pairs are circles on surfaces, (pairs,).
    """

    names: tuple[str, ...]
    friction: Array
    restitution: Array
    radii: Array
    bodies: tuple[tuple[int, ...], tuple[int, ...]]
    places: tuple[Complex, Complex]
    outlines: tuple[tuple[Outline, tuple[int, ...]], ...]
    sloped: NDArray[np.bool_]

    @classmethod
    def of(cls, mechanism: Mechanism, kinematics: Kinematics, constants: Constants) -> "Touch":
        """Read contacts, surfaces, shapes and pairs."""
        pairs = mechanism.touching
        own = [mechanism.contacts[pair.contact] for pair in pairs.values()]
        others = [pair.against for pair in pairs.values()]
        rows = kinematics.rows
        centres = [_centre(mechanism, name, kinematics, constants) for name in others]
        shape = (len(pairs), kinematics.places.shape[1])
        first = np.array([kinematics.place(one, constants) for one in own], dtype=complex)
        second = np.array([place for _, place in centres], dtype=complex)
        radii = np.array([constants.number(one.radius) for one in own])
        return cls(
            names=tuple(pairs),
            friction=_each(mechanism, pairs.values(), "friction", constants),
            restitution=_each(mechanism, pairs.values(), "restitution", constants),
            radii=radii,
            sloped=np.array([name in mechanism.surfaces for name in others], dtype=bool)
            & (radii > 0),
            bodies=(tuple(rows[one.body] for one in own), tuple(body for body, _ in centres)),
            places=(first.reshape(shape), second.reshape(shape)),
            outlines=tuple(
                (
                    _outline(mechanism, name, constants),
                    tuple(row for row, other in enumerate(others) if other == name),
                )
                for name in dict.fromkeys(others)
            ),
        )

    def at(self, pose: Pose, turning: Array) -> Contacts:
        """Every pair, at the points in time of a pose."""
        count = len(self.names)
        both = pose.points(np.concatenate(self.places))
        own, other = list(self.bodies[0]), list(self.bodies[1])
        apart = _seen_from(both[:count], both[count:], pose, other, turning)
        near = self._near(apart.z)
        tangent = -1j * near.normal
        radii = self.radii[:, None]
        spins = pose.spins[own] - pose.spins[other]
        x, y = apart.rate.real, apart.rate.imag
        (xx, xy, yy), (by_x, by_y) = near.curvature, near.turning
        Jn = _along(near.slope, apart.slopes)
        turned = radii * (turning[own] - turning[other])
        Jt = _along((tangent.real, tangent.imag), apart.slopes) + turned[..., None]
        return Contacts(
            gaps=near.gap - radii,
            slips=_dot(tangent, apart.rate) + radii * spins,
            gap_rates=near.slope[0] * x + near.slope[1] * y,
            Jn=Jn,
            Jt=Jt,
            Gn=_along(self._press(near), apart.slopes),
            gap_bias=near.slope[0] * apart.bias.real
            + near.slope[1] * apart.bias.imag
            + xx * x**2
            + 2 * xy * x * y
            + yy * y**2,
            slip_bias=_dot(tangent, apart.bias)
            + (by_x * x + by_y * y) * _dot(near.normal, apart.rate),
            normals=pose.turns[other] * near.normal,
        )

    def _press(self, near: Nearness) -> tuple[Array, Array]:
        """Unit vectors of the normal forces.

        Those of circles on ground, whose gap is a distance to first order, are along its slope:
        so they do no work.
        """
        (x, y), normal = near.slope, near.normal
        size, sloped = np.hypot(x, y), self.sloped[:, None]
        return np.where(sloped, x / size, normal.real), np.where(sloped, y / size, normal.imag)

    def _near(self, z: Complex) -> Nearness:
        """All pairs in their order, each by its own outline."""
        values = np.empty((len(SERIES), *z.shape))
        for outline, rows in self.outlines:
            values[:, list(rows)] = outline(z[list(rows)])
        return Nearness.of(values)


def _seen_from(
    contact: Points, centre: Points, pose: Pose, bodies: list[int], turning: Array
) -> Points:
    """The contacts in the frames of what they touch, and how they move there."""
    back, spin = pose.turns[bodies].conj(), pose.spins[bodies]
    apart, rate = contact.z - centre.z, contact.rate - centre.rate
    place = back * apart
    slopes = back[:, None] * (contact.slopes - centre.slopes)
    slopes -= 1j * place[:, None] * turning[bodies][..., None]
    bias = back * (contact.bias - centre.bias - 2j * spin * rate) - spin**2 * place
    return Points(place, back * rate - 1j * spin * place, slopes, bias)


def _centre(
    mechanism: Mechanism, name: str, kinematics: Kinematics, constants: Constants
) -> tuple[int, Complex]:
    """The body of a surface or shape, and its origin over the features."""
    if name in mechanism.surfaces:
        return kinematics.rows[GROUND], kinematics.fixed(kinematics.rows[GROUND], 0)
    shape = mechanism.shapes[name]
    body = kinematics.rows[shape.body]
    return body, kinematics.fixed(body, constants.vector(shape.at))


def _outline(mechanism: Mechanism, name: str, constants: Constants) -> Outline:
    if name in mechanism.surfaces:
        return Outline.surface(mechanism.surfaces[name], constants)
    return Outline.shape(mechanism.shapes[name], constants)


def _each(mechanism: Mechanism, pairs: Iterable[Pair], field: str, constants: Constants) -> Array:
    """Friction or restitution of every pair: its own, or the surface's."""
    found = []
    for pair in pairs:
        surface = mechanism.surfaces.get(pair.against)
        own = getattr(pair, field) or getattr(surface, field, None)
        found.append(constants.number(own, 1.0 if field == "friction" else 0.0))
    return np.array(found)


def _along(direction: tuple[Array, Array], slopes: Complex) -> Array:
    x, y = direction
    return np.asarray(x[:, None] * slopes.real + y[:, None] * slopes.imag)


def _dot(a: Complex, b: Complex) -> Array:
    return np.asarray(a.real * b.real + a.imag * b.imag)
