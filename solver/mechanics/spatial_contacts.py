"""Contacts of a URDF system with level ground: gaps, slips, the forces that hold them."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from schemas.expressions import Name, Tree, derivative
from schemas.urdf import contact_forces
from solver.mechanics.spatial_motion import Motions
from solver.mechanics.spatial_vectors import Vec3, applied, scaled, total, written
from solver.mechanics.trees import ONE, ZERO, less, minus, plus, times


@dataclass(frozen=True, slots=True)
class SpatialTouch:
    """A contact: the body that has it, its centre in the body's axes, its radius."""

    name: str
    body: str
    centre: Vec3
    radius: Tree

    def word(self, word: str) -> str:
        """One of its names."""
        return f"contact.{self.name}.{word}"


@dataclass(frozen=True, slots=True)
class SpatialHeld:
    """What is held, by name.

    ``place`` is kept at zero, or, not ``anchored``, where the phase starts; a rolling sphere has
    none. ``acceleration`` is a residual, and ``force`` what it is solved for; the norm of a
    quaternion needs none.
    """

    label: str
    force: str
    place: str | None
    rate: str
    acceleration: str
    anchored: bool = True


def spatial_touches(motions: Motions) -> dict[str, SpatialTouch]:
    """Every contact."""
    found = {}
    for name, one in motions.system.contacts.items():
        host = motions.bodies.hosts[one.link]
        centre = motions.shared(f"{name}#c", motions.place(host, written(one.at)))
        found[name] = SpatialTouch(name, host[0], centre, one.radius.tree)
    return found


def touching_loads(
    motions: Motions, touches: Mapping[str, SpatialTouch]
) -> Iterator[tuple[str, Vec3, Vec3]]:
    """The forces of contacts that touch: body, place and force in the body's axes."""
    for name, mode in motions.system.mode.items():
        touch = touches[name]
        there = contact_forces(name, mode)
        words = (touch.word(word) for word in ("tangential_x", "tangential_y", "normal"))
        x, y, z = (Name(word) if word in there else ZERO for word in words)
        force = motions.local(touch.body, (x, y, z))
        below = scaled(minus(touch.radius), motions.local(touch.body, (ZERO, ZERO, ONE)))
        yield touch.body, total(touch.centre, below), force


def held_contacts(motions: Motions, touches: Mapping[str, SpatialTouch]) -> list[SpatialHeld]:
    """Normals, then tangents, of the contacts that touch; those that are split are not held."""
    modes = {name: mode for name, mode in motions.system.mode.items() if str(mode) != "split"}
    found = []
    for name, mode in modes.items():
        gap = touches[name].word("gap")
        force = contact_forces(name, mode)[0]
        found.append(SpatialHeld(gap, force, gap, derivative(gap), derivative(gap, 2)))
    for name, mode in modes.items():
        for force in contact_forces(name, mode)[1:]:
            axis = force[-1]
            slip = touches[name].word(f"slip_{axis}")
            place = f"{name}.{axis}" if touches[name].radius == ZERO else None
            found.append(SpatialHeld(slip, force, place, slip, derivative(slip), anchored=False))
    return found


def contact_series(motions: Motions, touch: SpatialTouch) -> dict[str, Tree]:
    """The names that a contact brings along."""
    place, velocity, push = motions.located(touch.body, touch.centre)
    spin = applied(motions.axes[touch.body], motions.spins[touch.body])
    turning = applied(motions.axes[touch.body], motions.turnings[touch.body])
    gap, slip_x, slip_y = (touch.word(word) for word in ("gap", "slip_x", "slip_y"))
    height = motions.system.ground.height.tree
    return {
        gap: plus(place[2], minus(plus(height, touch.radius))),
        derivative(gap): velocity[2],
        derivative(gap, 2): push[2],
        slip_x: less(velocity[0], times(touch.radius, spin[1])),
        derivative(slip_x): less(push[0], times(touch.radius, turning[1])),
        slip_y: plus(velocity[1], times(touch.radius, spin[0])),
        derivative(slip_y): plus(push[1], times(touch.radius, turning[0])),
        **_absent(motions, touch),
    }


def _absent(motions: Motions, touch: SpatialTouch) -> dict[str, Tree]:
    """Forces that are not there are zero."""
    mode = motions.system.mode.get(touch.name)
    there = contact_forces(touch.name, mode) if mode else ()
    names = [touch.word(word) for word in ("normal", "tangential_x", "tangential_y")]
    return {name: ZERO for name in names if name not in there}
