"""The names that a mechanism brings along, as trees: places, energies, momenta."""

from schemas.expressions import Name, Number, Tree, derivative
from schemas.mechanisms import Mechanism, Place
from solver.mechanics.frames import Frames, rate, rates
from solver.mechanics.trees import (
    Vec,
    cross,
    dot,
    minus,
    over,
    plus,
    times,
    vector,
)

_HALF = Number(0.5)


def centres(frames: Frames) -> dict[str, Vec]:
    """The centre of mass of every body that has a mass; defined as ``BODY#cx``, ``BODY#cy``."""
    found = {}
    for name, body in frames.mechanism.bodies.items():
        if body.mass is not None and name in frames.frames:
            x, y = frames.world(vector(body.com), name)
            found[name] = frames.shared(f"{name}#cx", x), frames.shared(f"{name}#cy", y)
    return found


def places(frames: Frames) -> dict[str, Tree]:
    """``BODY.x`` and its kin, and those of points and contacts."""
    mechanism, trees = frames.mechanism, dict[str, Tree]()
    known = set(mechanism.coordinates)
    for name in mechanism.bodies:
        trees |= _moving(name, frames.place(Place(body=name)))
        trees[f"{name}.omega"] = rate(frames.angle(name))
    for name, place in (*mechanism.points.items(), *mechanism.contacts.items()):
        trees |= _moving(name, frames.place(place))
    return {name: tree for name, tree in trees.items() if name not in known}


def _moving(name: str, place: Vec) -> dict[str, Tree]:
    x, y = f"{name}.x", f"{name}.y"
    return {
        x: place[0],
        y: place[1],
        f"{name}.vx": Name(derivative(x)),
        f"{name}.vy": Name(derivative(y)),
    }


def whole(frames: Frames, stored: list[Tree]) -> dict[str, Tree]:
    """Centre of mass, momenta and energies; ``stored`` are the energies of springs."""
    mechanism, middles = frames.mechanism, centres(frames)
    masses = {name: _mass(mechanism, name) for name in middles}
    spins = {name: _inertia(mechanism, name) for name in middles}
    weight = Name("com#mass")
    speed: Vec = Name("com.vx"), Name("com.vy")
    middle: Vec = Name("com.x"), Name("com.y")
    about = [
        plus(times(spins[one], rate(frames.angle(one))), times(masses[one], cross(at, rates(at))))
        for one, at in middles.items()
    ]
    lift = vector(mechanism.gravity)
    moving = [
        plus(
            times(masses[one], dot(rates(at), rates(at))),
            times(spins[one], rate(frames.angle(one)), rate(frames.angle(one))),
        )
        for one, at in middles.items()
    ]
    falling = [minus(times(masses[one], dot(lift, at))) for one, at in middles.items()]
    return {
        weight.name: plus(*masses.values()),
        "com.x": over(plus(*(times(masses[n], at[0]) for n, at in middles.items())), weight),
        "com.y": over(plus(*(times(masses[n], at[1]) for n, at in middles.items())), weight),
        "com.vx": Name(derivative("com.x")),
        "com.vy": Name(derivative("com.y")),
        "com.px": times(weight, speed[0]),
        "com.py": times(weight, speed[1]),
        "com.spin": plus(*about, minus(times(weight, cross(middle, speed)))),
        "energy.kinetic": times(_HALF, plus(*moving)),
        "energy.potential": plus(*falling, *stored),
        "energy.total": plus(Name("energy.kinetic"), Name("energy.potential")),
    }


def _mass(mechanism: Mechanism, body: str) -> Tree:
    mass = mechanism.bodies[body].mass
    return Number(0.0) if mass is None else mass.tree


def _inertia(mechanism: Mechanism, body: str) -> Tree:
    inertia = mechanism.bodies[body].inertia
    return Number(0.0) if inertia is None else inertia.tree
