"""URDF texts for tests: written here, small."""

from typing import Any

from schemas.expressions import Name, derivative
from schemas.urdf import Urdf
from solver.lowering.derivations import Derivations
from solver.mechanics.spatial import SpatialEquations, spatial_equations
from solver.numeric.tape import Array, Scope, Tape, record


def link(name: str, mass: float = 1.0, com: str = "0.1 0.2 0.3", more: str = "") -> str:
    return (
        f'<link name="{name}"><inertial><origin xyz="{com}" rpy="0.3 -0.2 0.5"/>'
        f'<mass value="{mass}"/><inertia ixx="0.03" ixy="0.002" ixz="-0.004" iyy="0.04" '
        f'iyz="0.003" izz="0.05"/></inertial>{more}</link>'
    )


def joint(name: str, kind: str, parent: str, child: str, inside: str = "") -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f"{inside}</joint>"
    )


def robot(*parts: str) -> str:
    return f'<robot name="small">{"".join(parts)}</robot>'


PENDULUM = robot(
    '<link name="stand"/>',
    '<link name="bob"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/></inertial></link>',
    joint("hinge", "continuous", "stand", "bob", '<axis xyz="0 1 0"/>'),
)

TREE = robot(
    link("root", 3.0),
    link("slid"),
    link("swung", 2.0),
    link("welded", 0.5),
    link("skew"),
    link("led", 0.4),
    joint("slide", "prismatic", "root", "slid", '<origin xyz="0 0.1 0.2" rpy="0.1 0.2 0.3"/>'),
    joint(
        "swing",
        "revolute",
        "slid",
        "swung",
        '<origin xyz="0.3 0 0" rpy="1.5707963 0 0"/><axis xyz="0 0 -1"/>'
        '<limit lower="-1" upper="2" velocity="3" effort="40"/><dynamics damping="0.7"/>',
    ),
    joint("weld", "fixed", "swung", "welded", '<origin xyz="0 0.4 0" rpy="0 1 0"/>'),
    joint("askew", "continuous", "welded", "skew", '<axis xyz="1 2 3"/>'),
    joint(
        "follow",
        "revolute",
        "root",
        "led",
        '<axis xyz="0 1 0"/><mimic joint="swing" multiplier="-0.5" offset="0.2"/>'
        '<dynamics damping="0.3"/>',
    ),
)
"""Every kind of step but the free ones: skew axes, a weld, a follower, damping."""

LOOSE = robot(
    link("root"),
    link("sheet"),
    link("free"),
    joint("plane", "planar", "root", "sheet", '<axis xyz="0 1 1"/>'),
    joint("loose", "floating", "sheet", "free", '<origin xyz="1 0 0" rpy="0 0 1"/>'),
)


def system(text: str, **more: Any) -> Urdf:
    return Urdf.model_validate({"kind": "urdf", "text": text, **more})


def equations(one: Urdf, names: list[str]) -> tuple[SpatialEquations, Tape]:
    """The residuals, then some names: over coordinates, rates, accelerations, controls, forces,
    t and s.
    """
    found = spatial_equations(one)
    inputs = [
        *(derivative(name, order) for order in range(3) for name in one.coordinates),
        *one.control_names,
        *found.forces,
        "t",
        "s",
    ]
    derivations = Derivations(found.trees, {}, [], set(inputs).__contains__)
    wanted = [*found.rows, *names]
    derivations.demand(wanted)
    definitions = derivations.definitions(wanted)
    return found, record([Name(name) for name in wanted], Scope(inputs, {}, definitions))


def evaluated(tape: Tape, *blocks: Array) -> Array:
    """Rows (outputs, N) of a tape over blocks of inputs, (names, N) each."""
    inputs = [row for block in blocks for row in block]
    return tape(inputs, blocks[0].shape[1:])
