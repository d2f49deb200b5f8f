"""Contacts that push where they do not touch: complementarity, from states and forces alone."""

from collections.abc import Mapping

import numpy as np

from solver.certificate.steps import Steps
from solver.numeric import Array


def complementary(steps: Steps) -> dict[str, Array]:
    """By how much each law is missed in every step, name -> (N,).

    The smaller one of a gap in m, or a slip in m/s, and of a force over the weight; what has the
    wrong sign counts whole.
    """
    return {**_presses(steps), **_slides(steps), **_stopped(steps)}


def _presses(steps: Steps) -> Mapping[str, Array]:
    """A contact that is open does not push, none pulls, none is inside of anything."""
    sizes = np.abs(np.minimum(steps.gaps[:, 1:], steps.normal / steps.weight))
    return _named(steps, "", sizes)


def _slides(steps: Steps) -> Mapping[str, Array]:
    """Friction is within its cone, and where matter slips at its edge, and against the slip."""
    slips, push = steps.slips, steps.tangential / steps.weight
    spare = steps.model.friction[:, None] * steps.normal / steps.weight - np.abs(push)
    beyond = np.maximum(-spare, 0.0)
    if steps.method.friction == "no_slip":
        held = np.minimum(np.abs(slips), np.maximum(steps.normal / steps.weight, 0.0))
        return {**_named(steps, " cone", beyond), **_named(steps, " slip", held)}
    inner = np.minimum(np.abs(slips), np.maximum(spare, 0.0))
    along = np.where(slips * push > 0, np.minimum(np.abs(slips), np.abs(push)), 0.0)
    return {
        **_named(steps, " cone", beyond),
        **_named(steps, " slip", np.maximum(inner, along)),
    }


def _stopped(steps: Steps) -> Mapping[str, Array]:
    sizes = np.abs(np.minimum(steps.rooms[:, 1:], steps.stops.efforts / steps.weight))
    return dict(zip(steps.stops.names, sizes, strict=True))


def _named(steps: Steps, word: str, sizes: Array) -> Mapping[str, Array]:
    names = (f"contact {pair}{word}" for pair in steps.model.pairs)
    return dict(zip(names, sizes, strict=True))
