"""The published limits on the size of a model. A problem over one of them is refused by name."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ModelLimits:
    """What one problem may hold."""

    phases: int = 50
    static: int = 100
    stages: int = 20
    multistart: int = 200
    sweep: int = 1000
    """Points of one sweep."""
    sweep_values: int = 2_000_000
    """Points of a sweep times the values of its problem."""
    simulation_steps: int = 100_000
    """Of one simulation: its result has a polynomial for each."""
    states: int = 200
    controls: int = 200
    parameters: int = 1000
    integrals: int = 100
    constraints: int = 200
    """In a phase's ``path``, and as many in its ``boundary``."""
    bodies: int = 64
    """Of a mechanism; as many joints, motors, springs, loops, forces and torques."""
    contacts: int = 64
    """Of a mechanism; as many points, surfaces, shapes and pairs."""
    urdf_characters: int = 2_000_000
    """Of one URDF text."""
    urdf_elements: int = 50_000
    urdf_depth: int = 32
    urdf_links: int = 200
    """Of one robot; as many joints."""
    segments: int = 20_000
    """Of any mesh; the first mesh has at most a quarter of them."""
    nodes: int = 20_000
    """Operations, names and numbers of all expressions together."""
    values: int = 500_000
    """Numbers, texts, lists and objects of the whole document."""
    nesting: int = 64
    """Lists and objects within each other."""


MODEL_LIMITS = ModelLimits()
