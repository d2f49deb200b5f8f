"""Where the bodies of a mechanism are, and how that changes with its coordinates.

In the plane every body's angle is affine in the coordinates, and every place is a constant
complex matrix times some *features*: exp(i angle) of each body, the same times the coordinate of
each slider, and the coordinates themselves. So Jacobians and accelerations are those of the
features, for any number of places and points in time at once.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from schemas.mechanisms import (
    GROUND,
    Floating,
    Link,
    Mechanism,
    Place,
    Prismatic,
    Revolute,
    Welded,
)
from solver.numeric.tape import Array
from solver.simulation.constants import Constants

Complex = NDArray[np.complex128]


@dataclass(frozen=True, slots=True)
class Points:
    """Some places at N points in time.

    Attributes
    ----------
    z, rate
        Position and velocity, (places, N).
    slopes
        dz/dq, (places, n, N).
    bias
        The acceleration at zero dd(q), (places, N).
    """

    z: Complex
    rate: Complex
    slopes: Complex
    bias: Complex

    def __getitem__(self, rows: slice | list[int] | NDArray[np.intp]) -> "Points":
        """Some of the places."""
        return Points(self.z[rows], self.rate[rows], self.slopes[rows], self.bias[rows])


@dataclass(frozen=True, slots=True)
class Pose:
    """All features at N points in time, their slopes and rates, and the bodies' angles.

    Attributes
    ----------
    q, v
        Coordinates and velocities, (n, N).
    angles, spins
        Of every body, the ground first: rad and rad/s, (bodies + 1, N).
    turns
        exp(i angle), (bodies + 1, N).
    """

    q: Array
    v: Array
    angles: Array
    spins: Array
    turns: Complex
    features: Complex
    slopes: Complex
    rates: Complex
    bias: Complex

    def points(self, rows: Complex) -> Points:
        """The places that constant matrices (places, features) stand for."""
        flat = self.slopes.reshape(len(self.slopes), -1)
        slopes = (rows @ flat).reshape(len(rows), *self.slopes.shape[1:])
        return Points(rows @ self.features, rows @ self.rates, slopes, rows @ self.bias)


@dataclass(frozen=True, slots=True)
class Kinematics:
    """The constant matrices of a mechanism.

    Attributes
    ----------
    rows
        Body -> its number; the ground's is 0.
    coordinates
        Their names, n.
    turning, offsets
        The bodies' angles are ``turning @ q + offsets``: (bodies + 1, n) and (bodies + 1,).
    sliders
        For each slider the body that its axis turns with, and its coordinate.
    places
        The bodies' origins over the features, (bodies + 1, features).
    spread
        d(angle)/dq of what each feature turns with, (features, n).
    fixed_slopes
        Slopes of the coordinates as features, (features, n, 1).
    """

    rows: Mapping[str, int]
    coordinates: Sequence[str]
    turning: Array
    offsets: Array
    sliders: tuple[list[int], list[int]]
    places: Complex
    spread: Array
    fixed_slopes: Complex

    @classmethod
    def of(cls, mechanism: Mechanism, constants: Constants) -> "Kinematics":
        """Walk the mechanism's tree, parents first."""
        links = mechanism.links
        rows = {GROUND: 0, **{link.body: row for row, link in enumerate(links, 1)}}
        names = mechanism.coordinates
        found = [link for link in links if isinstance(link.joint, Prismatic)]
        sliders = (
            [rows[link.parent] for link in found],
            [names.index(link.coordinates[0]) for link in found],
        )
        count = len(rows)
        turning, offsets = np.zeros((count, len(names))), np.zeros(count)
        places = np.zeros((count, count + len(found) + len(names)), dtype=complex)
        for row, link in enumerate(links, 1):
            _hang(link, row, rows[link.parent], names, (turning, offsets), constants)
            _place(link, row, rows[link.parent], names, (places, sliders), constants)
        still = np.zeros((len(names), len(names)))
        spread = np.concatenate([turning, turning[sliders[0]], still])
        fixed = np.concatenate([np.zeros((count + len(found), len(names))), np.eye(len(names))])
        return cls(
            rows, names, turning, offsets, sliders, places, spread, fixed[..., None].astype(complex)
        )

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies, without the ground."""
        return list(self.rows)[1:]

    def place(self, place: Place, constants: Constants) -> Complex:
        """A place of a body over the features, (features,)."""
        return self.fixed(self.rows[place.body], constants.vector(place.at))

    def fixed(self, body: int, at: complex) -> Complex:
        """The same, by the number of the body and a vector in its frame."""
        row: Complex = self.places[body].copy()
        row[body] += at
        return row

    def pose(self, q: Array, v: Array) -> Pose:
        """All features at coordinates (n, N) and velocities (n, N)."""
        angles = self.turning @ q + self.offsets[:, None]
        spins, turns = self.turning @ v, np.exp(1j * angles)
        body, slider = self.sliders
        first, last = len(turns), len(turns) + len(slider)
        features = np.concatenate([turns, turns[body] * q[slider], q])
        turning = 1j * features
        turning[last:] = 0.0  # the coordinates themselves do not turn
        slopes = turning[:, None] * self.spread[..., None]
        slopes += self.fixed_slopes
        rates = turning * np.concatenate([spins, spins[body], v])
        rates[last:] += v
        bias = 1j * rates
        bias[:first] *= spins
        bias[first:last] *= spins[body]
        bias[last:] = 0.0
        if len(slider):
            slopes[range(first, last), slider] += turns[body]
            along = turns[body] * v[slider]
            rates[first:last] += along
            bias[first:last] += 2j * spins[body] * along
        return Pose(q, v, angles, spins, turns, features, slopes, rates, bias)


def _hang(
    link: Link,
    row: int,
    parent: int,
    names: Sequence[str],
    angles: tuple[Array, Array],
    constants: Constants,
) -> None:
    """The angle of a body: its joint's, on top of its parent's or by itself."""
    turning, offsets = angles
    joint = link.joint
    if isinstance(joint, Floating):
        turning[row, names.index(link.coordinates[2])] = 1.0
        return
    if isinstance(joint, Revolute):
        turning[row, names.index(link.coordinates[0])] = 1.0
        if link.coordinates[0] != link.joint_name:  # the angle to the world
            return
    turning[row] += turning[parent]
    offsets[row] = offsets[parent] + constants.number(joint.angle)


def _place(
    link: Link,
    row: int,
    parent: int,
    names: Sequence[str],
    features: tuple[Complex, tuple[list[int], list[int]]],
    constants: Constants,
) -> None:
    """The origin of a body over the features."""
    places, sliders = features
    bodies, joint = len(places), link.joint
    first = bodies + len(sliders[0])  # of the coordinates themselves
    match joint:
        case Floating():
            places[row, first + names.index(link.coordinates[0])] = 1.0
            places[row, first + names.index(link.coordinates[1])] = 1j
            return
        case Prismatic():
            column = sliders[1].index(names.index(link.coordinates[0]))
            places[row] = places[parent]
            places[row, bodies + column] = constants.unit(joint.axis)
        case Revolute() | Welded():
            places[row] = places[parent]
        case _:
            assert_never(joint)
    places[row, parent] += constants.vector(joint.at)
    places[row, row] -= constants.vector(joint.to)
