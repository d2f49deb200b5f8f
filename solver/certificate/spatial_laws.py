"""Laws of contact in space, from states and forces alone."""

from collections.abc import Mapping

import numpy as np

from solver.certificate.spatial_steps import SpatialSteps
from solver.numeric import Array


def spatial_complementary(steps: SpatialSteps) -> dict[str, Array]:
    """By how much each law is missed in every step, name -> (N,).

    As `solver.certificate.complementary.complementary`; the friction cone is the polygon of the
    method's directions, and what of it is spent the least that makes up the published force.
    """
    presses = np.abs(np.minimum(steps.gaps[:, 1:], steps.normal / steps.weight))
    stopped = np.abs(np.minimum(steps.rooms[:, 1:], steps.stops.efforts / steps.weight))
    return {
        **_named(steps, "", presses),
        **_slides(steps),
        **dict(zip(steps.stops.names, stopped, strict=True)),
    }


def _slides(steps: SpatialSteps) -> Mapping[str, Array]:
    """Friction is within its cone; at its edge where matter slips, and takes the most it can."""
    normal, push = steps.normal / steps.weight, steps.tangential / steps.weight
    spare = steps.friction * normal - spent(steps.directions, push)
    beyond = np.maximum(-spare, 0.0)
    fastest = np.max(np.einsum("dk,kpN->dpN", steps.directions, steps.slips), axis=0)
    if steps.method.friction == "no_slip":
        held = np.minimum(fastest, np.maximum(normal, 0.0))
        return {**_named(steps, " cone", beyond), **_named(steps, " slip", held)}
    inner = np.minimum(fastest, np.maximum(spare, 0.0))
    # the power that a force of this cone could take, less what this one takes, over its force
    taken = -np.sum(steps.slips * push, axis=0)
    largest = steps.friction * np.maximum(normal, 0.0)
    missed = np.maximum(fastest * largest - taken, 0.0)
    along = np.divide(missed, largest, out=np.zeros_like(missed), where=largest > 0)
    return {
        **_named(steps, " cone", beyond),
        **_named(steps, " slip", np.maximum(inner, np.minimum(along, largest))),
    }


def spent(directions: Array, push: Array) -> Array:
    """The least sum of parts along some directions that makes up forces (2, ...): (...).

    A force lies between two neighbours; their parts follow from it, and no others need less.
    """
    count = len(directions)
    width = 2 * np.pi / count
    angle = np.arctan2(push[1], push[0]) % width
    parts = np.sin(width - angle) + np.sin(angle)
    return np.asarray(np.hypot(*push) * parts / np.sin(width))


def _named(steps: SpatialSteps, word: str, sizes: Array) -> Mapping[str, Array]:
    names = (f"contact {pair}{word}" for pair in steps.pairs)
    return dict(zip(names, sizes, strict=True))
