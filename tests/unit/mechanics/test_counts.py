"""How much a residual costs: operations of the nine coordinates of a floating biped, counted."""

import pytest

from benchmarks.instructions import AIMS, counted
from schemas.mechanisms import Mechanism
from tests.support.lowered import Lowered
from tests.support.machines import machine


def test_the_biped_stays_within_its_counts() -> None:
    found = counted()
    assert found.keys() == AIMS.keys()
    for what, most in AIMS.items():
        assert 50 < found[what] <= most, what


@pytest.mark.parametrize("angles", ["relative", "absolute"])
def test_long_chains_cost_in_proportion(angles: str) -> None:
    """Operations and definitions grow with the number of bodies and no faster."""
    few, many = (Lowered(snake(count, angles)) for count in (10, 40))
    sizes = []
    for low in (few, many):
        names = [f"#dynamics {name}" for name in low.mechanism.coordinates]
        sizes.append(len(low.tape(names).steps))
    assert sizes[1] < 4.2 * sizes[0]


def snake(count: int, angles: str) -> Mechanism:
    """Links that hang on each other from a floating one."""
    link = {"mass": 1, "inertia": 0.1, "com": [0.1, 0.02]}
    joints: dict[str, object] = {"free": {"kind": "floating", "child": "link0"}}
    for one in range(1, count):
        joints[f"joint{one}"] = {
            "kind": "revolute",
            "parent": f"link{one - 1}",
            "child": f"link{one}",
            "at": [0.2, 0],
        }
    bodies = {f"link{one}": link for one in range(count)}
    return machine({"angles": angles, "bodies": bodies, "joints": joints})
