"""How bodies move from knot to knot in space: their centres straight, and by a turn each.

Links that are welded to each other are one body: each on its own would go straight, and so a
little slower than it turns. The turn between two rotations is about an axis that stands still both
in the world and in the body; over the time of the step it is the body's spin.
"""

from dataclasses import dataclass

import numpy as np

from schemas.urdf import WORLD, Link
from solver.certificate.spatial_slipping import turned
from solver.certificate.spatial_steps import SpatialSteps
from solver.numeric import Array
from solver.simulation.spatial_instant import SpatialInstant

Motion = tuple[Array, Array]
"""Of a body's centre, m/s in the world, and of its turning, rad/s in its own axes: (N, 3) each."""


@dataclass(frozen=True, slots=True)
class SpatialChords:
    """One body.

    Attributes
    ----------
    host
        The link that its axes are those of.
    mass, com, inertia
        kg; in m, (3,); about that, kg m^2, (3, 3).
    axes
        At both ends of the steps, to the world, (2, N, 3, 3).
    after, before
        Of the steps, and of those before them: for the first the velocities at its start; in a
        period the last step comes before the first.
    """

    host: str
    mass: float
    com: Array
    inertia: Array
    axes: Array
    after: Motion
    before: Motion

    @property
    def jumps(self) -> Motion:
        """By how much they change at the start of each step."""
        (V1, w1), (V0, w0) = self.after, self.before
        return V1 - V0, w1 - w0

    @property
    def turning(self) -> Array:
        """The change of its angular momentum, N m s, in the axes at the start of steps, (N, 3)."""
        carried = np.swapaxes(self.axes[0], 1, 2) @ self.axes[1]
        after = np.einsum("Nij,jk,Nk->Ni", carried, self.inertia, self.after[1])
        return np.asarray(after - self.before[1] @ self.inertia)

    def energy(self, motion: Motion) -> Array:
        """J, (N,)."""
        V, w = motion
        turning = np.einsum("Ni,ij,Nj->N", w, self.inertia, w)
        return np.asarray((self.mass * np.sum(V**2, axis=1) + turning) / 2)


def spatial_chords(steps: SpatialSteps) -> list[SpatialChords]:
    """Of all bodies with a mass or an inertia."""
    hosts = dict[str, str]()
    for one in steps.model.system.carriages:
        hosts[one.link] = one.link if one.steps else hosts.get(one.parent, WORLD)
    links = [link for link in steps.knots.parts.moving if link.mass or np.any(link.inertia)]
    names = dict.fromkeys(hosts[link.name] for link in links)
    return [_of(steps, host, [one for one in links if hosts[one.name] == host]) for host in names]


def _of(steps: SpatialSteps, host: str, links: list[Link]) -> SpatialChords:
    mass, com, inertia = _welded(steps.knots, host, links)
    at = steps.knots.frames[host].shifted(com)
    own = np.swapaxes(at.axes, 1, 2)
    h = steps.lengths[:, None]
    V, w = np.diff(at.place, axis=0) / h, _into(own[:-1], turned(at.axes)) / h
    if steps.periodic:
        earlier, last = steps.earlier.frames[host].shifted(com), steps.lengths[-1]
        turn = turned(np.concatenate([earlier.axes, at.axes[:1]]))
        first = (at.place[:1] - earlier.place) / last, _into(own[:1], turn) / last
    else:
        first = at.velocity[:1], _into(own[:1], at.spin[:1])
    before = np.concatenate([first[0], V[:-1]]), np.concatenate([first[1], w[:-1]])
    ends = np.stack([at.axes[:-1], at.axes[1:]])
    return SpatialChords(host, mass, com, inertia, ends, (V, w), before)


def _welded(at: SpatialInstant, host: str, links: list[Link]) -> tuple[float, Array, Array]:
    """Mass, centre and inertia of links in the axes of one of them."""
    frame, mass = at.frames[host], sum(link.mass for link in links)
    found = []
    for link in links:
        own = at.frames[link.name].shifted(np.array(link.com))
        turn = frame.axes[0].T @ own.axes[0]
        place = frame.axes[0].T @ (own.place - frame.place)[0]
        found.append((link.mass, place, turn @ np.array(link.inertia) @ turn.T))
    com = sum((one * place for one, place, _ in found), np.zeros(3)) / (mass or 1.0)
    inertia = np.zeros((3, 3))
    for one, place, own_inertia in found:
        d = place - com
        inertia += own_inertia + one * (d @ d * np.eye(3) - np.outer(d, d))
    return mass, com, inertia


def _into(axes: Array, vectors: Array) -> Array:
    return np.asarray(np.einsum("Nij,Nj->Ni", axes, vectors))
