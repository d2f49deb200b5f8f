"""Steps of the discrete gradient in space put to numbers, and their energies by the simulator."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
from scipy.spatial.transform import Rotation

from schemas import resolve
from schemas.methods import ContactImplicit
from schemas.urdf import Urdf
from solver.contact.space import around, spatial_forces
from solver.discrete import Step, step_rows
from solver.expressions import SX
from solver.mechanics.spatial_principle import spatial_principle
from solver.numeric.tape import Array
from solver.simulation.spatial import SpatialMultibody
from solver.simulation.spatial_instant import SpatialInstant

DIRECTIONS = 4
WIDE = 0.3
METHOD = ContactImplicit.model_validate(
    {"kind": "contact_implicit", "discretisation": "discrete_gradient", "directions": DIRECTIONS}
)


@dataclass(frozen=True)
class Instance:
    """Numbers of a step: coordinates at three knots, (3, n_q), two lengths and controls."""

    q: Array
    before: float
    h: float
    controls: Mapping[str, float]

    @property
    def v0(self) -> Array:
        """The chord of the step before."""
        return np.asarray((self.q[1] - self.q[0]) / self.before)

    @property
    def v1(self) -> Array:
        """The chord of the step."""
        return np.asarray((self.q[2] - self.q[1]) / self.h)


@dataclass(frozen=True)
class Books:
    """The energies of a step, J: what is gained, put in, and lost."""

    kinetic: float
    potential: float
    drives: float
    forces: float
    normal: float
    friction: float
    stops: float
    damped: float
    dissipated: float


class SpatialRows:
    """The rows of a system's steps, and everything else of them by the simulator."""

    def __init__(self, posted: Urdf) -> None:
        self.posted = posted
        self.system = system = spatial_forces(posted, METHOD, 1.0).system
        assert isinstance(system, Urdf)
        self.coordinates, self.controls = list(system.coordinates), list(system.control_names)
        self.principle = spatial_principle(system)
        count, size = len(self.coordinates), len(self.controls)
        q0, v0, q1, v1 = (SX.sym(name, count) for name in ("q0", "v0", "q1", "v1"))
        (h, before), u = (SX.sym(name) for name in ("h", "before")), SX.sym("u", size)
        known = {name: SX(value) for name, value in resolve.parameters(system).items()}
        known |= {"t": SX(0)} | {name: u[i] for i, name in enumerate(self.controls)}
        rows = step_rows(self.principle, Step(q0, v0, q1, v1, h, before, known))
        bare = replace(self.principle, norms=())
        whole = step_rows(bare, Step(q0, v0, q1, v1, h, before, known))
        outputs = [rows.momentum, rows.slips, rows.dissipation, whole.momentum]
        inputs = [q0, v0, q1, v1, h, before, u]
        self.function = ca.Function("step", inputs, outputs, {"cse": True})
        self.model = SpatialMultibody.of(posted)

    def random(self, seed: int = 0, h: float = 0.3, before: float = 0.2) -> Instance:
        """Bodies turn by a radian or so, from anywhere; quaternions have the norm 1."""
        rng = np.random.default_rng(seed)
        start, *steps = rng.normal(size=(3, len(self.coordinates)))
        q = self.normed(start + np.array([0 * start, *(WIDE * np.cumsum(steps, axis=0))]))
        controls = dict(zip(self.controls, rng.normal(size=len(self.controls)), strict=True))
        return Instance(q, before, h, controls)

    def normed(self, q: Array) -> Array:
        """Coordinates (..., n_q) with quaternions of norm 1."""
        q = q.copy()
        for first in self.posted.balls:
            start = self.coordinates.index(first)
            part = q[..., start : start + 4]
            q[..., start : start + 4] = part / np.linalg.norm(part, axis=-1, keepdims=True)
        return q

    def rows(self, one: Instance, *, whole: bool = False) -> tuple[Array, Array, float]:
        """Momentum (n_q,), slips (2 contacts,) and dissipation.

        The ``whole`` momentum has what pushes along a quaternion, and no row for its norm.
        """
        controls = np.array([one.controls.get(name, 0.0) for name in self.controls])
        where = one.q[1], one.v0, one.q[2], one.v1
        found = self.function(*where, one.h, one.before, controls)
        momentum, slips, dissipation, full = (np.array(part).ravel() for part in found)
        return full if whole else momentum, slips, float(dissipation[0])

    def at(self, one: Instance) -> SpatialInstant:
        """The links at the three knots, under the chords that end there."""
        v = np.stack([one.v0, one.v0, one.v1])
        names = self.posted.control_names
        u = np.array([[one.controls.get(name, 0.0)] * 3 for name in names]).reshape(len(names), 3)
        return self.model.at(np.zeros(3), one.q.T, v.T, u)

    def friction(self, name: str, one: Instance) -> Array:
        """Along x and y, N."""
        pushes = [one.controls.get(f"contact.{name}#push{k}", 0.0) for k in range(DIRECTIONS)]
        return np.asarray(np.transpose(around(DIRECTIONS)) @ pushes)

    def books(self, one: Instance) -> Books:
        """Its energies, from where bodies are at the knots alone."""
        at, work, system = self.at(one), dict[str, float](), self.posted
        kinetic = dissipated = potential = 0.0
        for mass, inertia, places, axes in self.bodies(at):
            before, after = np.diff(places, axis=0) / [[one.before], [one.h]]
            turns = Rotation.from_matrix(np.swapaxes(axes[:-1], 1, 2) @ axes[1:]).as_rotvec()
            slow, fast = turns / [[one.before], [one.h]]
            jump, change = after - before, fast - slow
            kinetic += mass / 2 * float(after @ after - before @ before)
            kinetic += float(fast @ inertia @ fast - slow @ inertia @ slow) / 2
            dissipated += float(mass * jump @ jump + change @ inertia @ change) / 2
            potential -= mass * float(self.model.numbers.gravity @ (places[2] - places[1]))
        moved = dict(zip(self.coordinates, one.q[2] - one.q[1], strict=True))
        get = one.controls.get
        work["drives"] = sum(get(f"motor.{n}.torque", 0.0) * moved[n] for n in system.motor_joints)
        work["stops"] = sum(
            (get(f"limit.{name}#lower", 0.0) - get(f"limit.{name}#upper", 0.0)) * moved[name]
            for name in self.coordinates
        )
        slips = self.rows(one)[1].reshape(-1, 2) * one.h
        touching = zip(system.touching, slips, strict=True)
        work["friction"] = sum(float(self.friction(name, one) @ slip) for name, slip in touching)
        work["normal"] = sum(
            get(f"contact.{name}.normal", 0.0) * float(at.gap(name)[2] - at.gap(name)[1])
            for name in system.touching
        )
        return Books(
            kinetic, potential, damped=self._damped(one), dissipated=dissipated,
            forces=self._pushed(at), **work,
        )  # fmt: skip

    def bodies(self, at: SpatialInstant) -> Iterator[tuple[float, Array, Array, Array]]:
        """Links that are welded to each other: mass, inertia about their centre in the axes of
        the first one, the centre's places (3, 3) and the axes (3, 3, 3).
        """
        hosts: dict[str, str] = {}
        for one in self.posted.carriages:
            hosts[one.link] = one.link if one.steps else hosts.get(one.parent, "world")
        for host in dict.fromkeys(hosts.values()):
            links = [link for link in at.parts.moving if hosts[link.name] == host]
            if mass := sum(link.mass for link in links):
                axes = at.frames[host].axes
                frames = [at.frames[link.name].shifted(np.array(link.com)) for link in links]
                weighed = [b.mass * f.place for b, f in zip(links, frames, strict=True)]
                middle = np.sum(weighed, axis=0) / mass
                inertia = np.zeros((3, 3))
                for link, frame in zip(links, frames, strict=True):
                    turn, d = axes[0].T @ frame.axes[0], axes[0].T @ (frame.place - middle)[0]
                    inertia += turn @ np.array(link.inertia) @ turn.T
                    inertia += link.mass * (d @ d * np.eye(3) - np.outer(d, d))
                yield mass, inertia, middle, axes

    def _damped(self, one: Instance) -> float:
        lost = 0.0
        for carriage in self.posted.carriages:
            for step in carriage.steps if carriage.damping else ():
                rate = step.factor * one.v1[self.coordinates.index(step.coordinates[0])]
                lost += carriage.damping * rate**2 * one.h
        return lost

    def _pushed(self, at: SpatialInstant) -> float:
        work, numbers = 0.0, self.model.numbers
        for (name, force), values in zip(self.posted.forces.items(), at.pushing, strict=True):
            frame = at.frames[force.link]
            along = numbers.directions[name]
            if force.frame == "link":
                along = frame.axes[2] @ along
            places = frame.shifted(numbers.places[name]).place
            work += float(values[2] * along @ (places[2] - places[1]))
        return work
