"""The names that a URDF system brings along, as trees: places, energies, momenta.

Velocities are given as such, not left to differentiation: ``LINK.d(x)`` costs one rotation.
"""

from collections.abc import Iterable, Mapping

from schemas.expressions import Call, Name, Number, Tree, derivative
from schemas.urdf import Pose, motor_torque
from schemas.urdf.names import AXES as ENTRIES
from solver.mechanics.spatial_bodies import Body
from solver.mechanics.spatial_contacts import SpatialTouch, contact_series
from solver.mechanics.spatial_motion import Motions
from solver.mechanics.spatial_vectors import (
    AXES,
    NOWHERE,
    Vec3,
    applied,
    constant,
    cross,
    dot,
    matrix,
    named,
    scaled,
    total,
    written,
)
from solver.mechanics.trees import minus, over, plus, square, times

_HALF = Number(0.5)


def series(motions: Motions, touches: Mapping[str, SpatialTouch]) -> dict[str, Tree]:
    """Every name of ``system.defined``; velocities and accelerations of places beside them."""
    system, trees = motions.system, dict[str, Tree]()
    for link in system.tree.links:
        host = motions.bodies.hosts[link]
        trees |= _places(motions, link, host) | _turns(motions, link, host)
    for name, touch in touches.items():
        trees |= _located(name, motions.located(touch.body, touch.centre))
        trees |= contact_series(motions, touch)
    trees |= _whole(motions) | _drives(motions) | _followers(motions)
    for first in system.balls:
        prefix = first.rpartition(".")[0]
        parts = [square(Name(f"{prefix}.{one}")) for one in ("qw", "qx", "qy", "qz")]
        trees[f"{prefix}.norm"] = Call("sqrt", (plus(*parts),))
    known = {*system.coordinates, *system.control_names}
    return {name: tree for name, tree in trees.items() if not _taken(name, known)}


def _taken(name: str, known: set[str]) -> bool:
    """Whether a name, or what it is a derivative of, is a coordinate."""
    return name in known or derivative(name, -1) in known or derivative(name, -2) in known


def _places(motions: Motions, name: str, host: tuple[str, Pose]) -> dict[str, Tree]:
    body, pose = host
    return _located(name, motions.located(body, constant(pose.origin)))


def _located(name: str, moving: tuple[Vec3, Vec3, Vec3]) -> dict[str, Tree]:
    """Place, velocity and acceleration of a point under their names."""
    trees: dict[str, Tree] = {}
    for axis, place, velocity, push in zip(AXES, *moving, strict=True):
        own = f"{name}.{axis}"
        rate = derivative(own)
        trees |= {own: place, rate: velocity, derivative(own, 2): push}
        trees[f"{name}.v{axis}"] = Name(rate)
    return trees


def _turns(motions: Motions, name: str, host: tuple[str, Pose]) -> dict[str, Tree]:
    body = host[0]
    spin, turning = motions.spins[body], motions.turnings[body]
    trees: dict[str, Tree] = {}
    for axis, one, rate in zip(
        AXES, motions.world(body, spin), motions.world(body, turning), strict=True
    ):
        trees |= {f"{name}.w{axis}": one, derivative(f"{name}.w{axis}"): rate}
    entries = [entry for row in motions.oriented(host) for entry in row]
    return trees | {f"{name}.{word}": one for word, one in zip(ENTRIES, entries, strict=True)}


def _whole(motions: Motions) -> dict[str, Tree]:
    """Centre of mass, momenta and energies."""
    bodies = [one for one in motions.bodies.bodies.values() if one.mass or one.inertia[0][0]]
    mass = Number(sum(body.mass for body in bodies))
    kinetic = times(_HALF, plus(*(_lively(motions, body) for body in bodies)))
    middle = named("com.")
    weight = scaled(minus(mass), written(motions.system.gravity))
    momentum = total(NOWHERE, *(_momentum(motions, body) for body in bodies))
    spin = total(NOWHERE, *(_spin(motions, body) for body in bodies))
    about = cross(middle, named("com.p"))
    trees: dict[str, Tree] = {
        "energy.kinetic": kinetic,
        "energy.potential": dot(weight, middle),
        "energy.total": plus(Name("energy.kinetic"), Name("energy.potential")),
    }
    places = total(NOWHERE, *(_first(motions, body) for body in bodies))
    for axis, place, one, turn, shift in zip(AXES, places, momentum, spin, about, strict=True):
        rate = derivative(f"com.{axis}")
        trees |= {
            f"com.{axis}": over(place, mass),
            rate: over(Name(f"com.p{axis}"), mass),
            f"com.v{axis}": Name(rate),
            f"com.p{axis}": one,
            f"com.spin_{axis}": plus(turn, minus(shift)),
        }
    return trees


def _first(motions: Motions, body: Body) -> Vec3:
    """Mass times place."""
    here = scaled(Number(body.mass), motions.origins[body.name])
    return total(here, motions.world(body.name, constant(body.moment)))


def _moving(motions: Motions, body: Body) -> Vec3:
    """A body's momentum in its own axes."""
    drag = scaled(Number(body.mass), motions.drags[body.name])
    moment = cross(motions.spins[body.name], constant(body.moment))
    return motions.shared(f"{body.name}#m", total(drag, moment))


def _momentum(motions: Motions, body: Body) -> Vec3:
    return motions.world(body.name, _moving(motions, body))


def _spin(motions: Motions, body: Body) -> Vec3:
    """A body's angular momentum about the world's origin."""
    name = body.name
    own = applied(matrix(body.inertia), motions.spins[name])
    dragged = cross(constant(body.moment), motions.drags[name])
    carried = cross(motions.origins[name], _momentum(motions, body))
    return total(motions.world(name, total(own, dragged)), carried)


def _lively(motions: Motions, body: Body) -> Tree:
    """Twice a body's kinetic energy: v (m v + w x mc) + w (I w + mc x v)."""
    drag, spin = motions.drags[body.name], motions.spins[body.name]
    own = applied(matrix(body.inertia), spin)
    return plus(
        dot(drag, _moving(motions, body)),
        dot(spin, total(own, cross(constant(body.moment), drag))),
    )


def _drives(motions: Motions) -> dict[str, Tree]:
    trees: dict[str, Tree] = {}
    for joint in motions.system.motor_joints:
        speed = Name(derivative(joint))
        trees |= {
            f"motor.{joint}.speed": speed,
            f"motor.{joint}.power": times(Name(motor_torque(joint)), speed),
        }
    return trees


def _followers(motions: Motions) -> dict[str, Tree]:
    joints: Iterable[tuple[str, Tree]] = (
        (
            joint.name,
            plus(times(Number(led.multiplier), Name(led.joint)), Number(led.offset)),
        )
        for joint in motions.system.tree.joints
        if (led := joint.mimic) is not None
    )
    return dict(joints)
