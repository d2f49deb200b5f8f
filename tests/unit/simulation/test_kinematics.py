"""Places, velocities, slopes and accelerations of everything, against differences."""

import numpy as np
import pytest

from schemas import resolve
from schemas.expressions import Expression, constant
from schemas.mechanisms import Mechanism
from solver.simulation.multibody import Multibody
from tests.support.machines import cart_pole, chain, crane, double_pendulum

MACHINES = {
    "double_pendulum": double_pendulum(),
    "absolute": double_pendulum(angles="absolute"),
    "cart_pole": cart_pole(),
    "chain": chain(),
    "chain_absolute": chain(angles="absolute"),
    "crane": crane(),
    "crane_absolute": crane(angles="absolute"),
}
STEP = 1e-6


@pytest.fixture(params=list(MACHINES.values()), ids=list(MACHINES))
def model(request: pytest.FixtureRequest) -> Multibody:
    machine: Mechanism = request.param
    return Multibody.of(machine)


@pytest.fixture
def motion(model: Multibody) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    generator = np.random.default_rng(5)
    n = len(model.coordinates)
    return generator.normal(size=(n, 4)), generator.normal(size=(n, 4)), np.zeros(4)


def test_rates_and_slopes_are_those_of_the_places(model: Multibody, motion: tuple) -> None:
    q, v, t = motion
    at, ahead, behind = (model.at(t, q + shift * v, v) for shift in (0, STEP, -STEP))
    rows = np.array(list(model.parts.spots.values()))
    points = [one.pose.points(rows) for one in (at, ahead, behind)]
    rate = (points[1].z - points[2].z) / (2 * STEP)
    np.testing.assert_allclose(points[0].rate, rate, atol=1e-8)
    np.testing.assert_allclose(
        np.einsum("pnN,nN->pN", points[0].slopes, v), points[0].rate, atol=1e-13
    )
    bias = (points[1].rate - points[2].rate) / (2 * STEP)
    np.testing.assert_allclose(points[0].bias, bias, atol=1e-7)
    spins = (ahead.pose.angles - behind.pose.angles) / (2 * STEP)
    np.testing.assert_allclose(at.pose.spins, spins, atol=1e-8)


def test_joints_hold_their_places_together(model: Multibody, motion: tuple) -> None:
    q, _, _ = motion
    frames = dict(zip(model.bodies, model.frames(q), strict=True))
    z = {name: x + 1j * y for name, (x, y, _) in frames.items()} | {"ground": np.zeros(4)}
    turn = {name: np.exp(1j * a) for name, (_, _, a) in frames.items()} | {"ground": np.ones(4)}
    for link in model.mechanism.links:
        joint = link.joint
        if joint.kind not in ("revolute", "welded"):
            continue
        at, to = (complex(*_numbers(model, one)) for one in (joint.at, joint.to))
        first = z[link.parent] + turn[link.parent] * at
        second = z[link.body] + turn[link.body] * to
        np.testing.assert_allclose(first, second, atol=1e-14)


def _numbers(model: Multibody, pair: list[Expression]) -> list[float]:
    names = resolve.parameters(model.mechanism)
    return [constant(one.tree, names) for one in pair]


def test_a_slider_goes_along_its_axis_in_the_frame_of_its_parent() -> None:
    model = Multibody.of(crane())
    q = np.zeros(len(model.coordinates))
    lift = model.coordinates.index("lift")
    moved = q.copy()
    moved[lift] = 0.25
    frame = model.bodies.index("frame")
    shift = (model.frames(moved) - model.frames(q))[frame]
    # the bridge is turned by 0.1 rad, the axis is the bridge's y
    np.testing.assert_allclose(shift, [-0.25 * np.sin(0.1), 0.25 * np.cos(0.1), 0], atol=1e-14)


def test_absolute_angles_say_where_relative_ones_lead() -> None:
    relative, absolute = Multibody.of(chain()), Multibody.of(chain(angles="absolute"))
    q = np.array([0.2, 0.1, 0.4, -0.7, 0.3])
    turned = q.copy()
    turned[3] += q[2] + 0.3  # the hinge's own angle, on top of its parent's and its offset
    assert absolute.coordinates[3] == "second.angle"
    np.testing.assert_allclose(relative.frames(q), absolute.frames(turned), atol=1e-14)
    values = absolute.values(["hinge", "d(hinge)"], 0.0, turned, np.ones(5), np.zeros(0))
    np.testing.assert_allclose(values, [-0.7, 0.0], atol=1e-14)


def test_every_name_that_needs_no_forces_has_a_value() -> None:
    model = Multibody.of(crane())
    late = ("normal", "tangential")
    names = [name for name in model.mechanism.defined if name.rpartition(".")[2] not in late]
    n = len(model.coordinates)
    values = model.values(names, 0.3, np.full((n, 2), 0.1), np.ones((n, 2)), np.ones((3, 2)))
    assert np.all(np.isfinite(values))
    rates = {"x": "vx", "y": "vy", "angle": "omega"}
    pairs = [(f"{b}.d({w})", f"{b}.{r}") for b in model.bodies for w, r in rates.items()]
    for one, other in pairs:
        assert np.array_equal(*model.values([one, other], 0.0, np.ones(n), np.ones(n), np.ones(3)))
