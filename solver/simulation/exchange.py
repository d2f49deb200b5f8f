"""Whether something gives or takes energy along a motion: else its change is the method's error."""

from schemas.mechanisms import Mechanism
from schemas.mechanisms.parts import ONE, ZERO
from schemas.simulated import SimulationEvent
from schemas.urdf import Urdf
from solver.simulation.experiment import Experiment, Outcome

SAME = 1e-9
"""A rebound within this share of the approach gives all of it back."""


def changing(experiment: Experiment, outcome: Outcome) -> bool:
    """Whether forces beside gravity and springs, friction or impacts do work; controls apart."""
    system = experiment.simulation.system
    if isinstance(system, Mechanism):
        acts = bool(system.forces or system.torques or _braking(system))
    elif isinstance(system, Urdf):
        acts = bool(system.forces) or any(one.damping for one in system.carriages)
    else:
        return True
    held = [{name: str(doing) for name, doing in system.mode.items()}]
    words = [
        word for one in (*held, *(span.contacts for span in outcome.modes)) for word in one.values()
    ]
    slides = any(word.startswith("sliding") for word in words)
    return acts or slides or any(_lossy(event) for event in outcome.events)


def _braking(system: Mechanism) -> bool:
    springs = system.springs.values()
    return any(motor.losses for motor in system.motors.values()) or any(
        one.damping.tree != ZERO.tree or one.engaged.tree != ONE.tree for one in springs
    )


def _lossy(event: SimulationEvent) -> bool:
    """An impact that does not give back what it takes."""
    if event.kind != "impact" or event.gap_rate is None:
        return event.kind == "guard"
    before, after = event.gap_rate
    return bool(event.tangential) or abs(before + after) > SAME * abs(before)
