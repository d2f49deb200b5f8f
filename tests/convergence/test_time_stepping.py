"""Time stepping tends to the motion by events as its steps become small: first order."""

from typing import Any

import pytest

from tests.support.touching import block, box, last, run

STEPS = (4e-3, 2e-3, 1e-3, 5e-4)


def distances(system: dict[str, Any], duration: float, initial: dict[str, float]) -> list[float]:
    exact = last(run(system, duration, initial=initial))
    found = []
    for step in STEPS:
        method = {"kind": "time_stepping", "step": step}
        state = last(run(system, duration, method, initial=initial))
        found.append(max(abs(state[name] - value) for name, value in exact.items()))
    return found


@pytest.mark.parametrize(
    ("system", "duration", "initial"),
    [
        (block(0.3), 2.0, {"d(across)": 3.0}),
        (block(0.2, slope=1.0), 1.0, {"d(across)": 1.0, "d(up)": 1.0}),
        (box(0.3), 0.4, {"box.y": 1.0, "box.angle": 0.2, "box.d(x)": 1.0}),
        (box(0.9), 0.6, {"box.y": 0.7, "box.angle": 0.1, "box.d(angle)": -1.0}),
    ],
    ids=["slides to rest", "turns round", "lands on a corner", "lands and sticks"],
)
def test_steps_tend_to_events(
    system: dict[str, Any], duration: float, initial: dict[str, float]
) -> None:
    found = distances(system, duration, initial)
    # An impact falls anywhere in its step: the order shows over a factor of eight, not at each.
    assert found[-1] < found[0] / 4
    assert found[-1] < 20 * STEPS[-1]
