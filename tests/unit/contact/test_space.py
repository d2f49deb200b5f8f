"""Time steps through contact in space: friction cones of many sides, stops, rolling."""

import numpy as np
import pytest
from scipy.optimize import root

from schemas.methods import ContactImplicit
from schemas.results import Solution, SolutionStatus
from schemas.urdf import Urdf
from solver import solve
from solver.contact.forces import forces_of
from solver.contact.names import SpaceNames
from solver.contact.slacks import Guessed
from solver.contact.space import around
from solver.posing import Posing
from tests.support import pucks
from tests.support.pucks import FRICTION, RADIUS, G

Array = np.ndarray
WAYS = ("discrete_gradient", "backward_euler")
TURNS = (0.0, 0.3, 0.6, 0.9)


def test_directions_are_even_and_opposite_ones_exactly_so() -> None:
    directions = np.array(around(6))
    assert np.array_equal(directions[:3], -directions[3:])
    assert np.allclose(
        directions @ directions.T, np.cos(np.pi / 3 * np.subtract.outer(*[range(6)] * 2))
    )
    assert around(4)[:2] == [(1.0, 0.0), (0.0, 1.0)]


@pytest.mark.parametrize("count", [4, 6, 8, 16])
def test_a_guessed_force_is_shared_exactly(count: int) -> None:
    names = SpaceNames("c")
    push = np.array([[1.0, -2.0, 0.0], [0.5, 3.0, 0.0]])
    nothing = np.zeros(3)
    touch = Guessed(nothing, nothing + 9.0, np.zeros((2, 3)), push)
    rows = touch.spatial("c", [names.push(k) for k in range(count)])
    shares = np.array([rows[names.push(k)] for k in range(count)])
    assert np.allclose(np.transpose(around(count)) @ shares, push)
    assert shares.min() >= 0.0


def test_pairs_are_two_and_one_for_each_direction() -> None:
    phase = pucks.sliding().phases[0]
    labels = [pair.label for pair in forces_of(phase, _method(directions=6)).pairs]
    assert labels == ["rim opens", *(f"rim slides {k}" for k in range(6)), "rim sticks"]
    labels = [pair.label for pair in forces_of(phase, _method(friction="no_slip")).pairs]
    assert labels == ["rim opens", "rim sticks"]


def test_a_guess_slips_as_it_moves() -> None:
    _, setting = Posing.of(pucks.sliding(speed=2.0)).prepared()
    (guess,) = setting.guesses
    names = SpaceNames("rim")
    fractions = np.array([0.0, 0.5, 1.0])
    speed, gap = guess.sample([names.speed, names.gap], fractions)
    assert speed == pytest.approx(2.0)
    assert gap == pytest.approx(0.0)
    pushed = guess.sample([names.ahead(0), names.ahead(2)], fractions)
    assert pushed[0] == pytest.approx(4.0)
    assert pushed[1] == pytest.approx(0.0), "it slips against none but direction 2"


def test_the_posted_system_is_left_alone() -> None:
    phase = pucks.sliding().phases[0]
    system = phase.system
    assert isinstance(system, Urdf)
    before = list(system.control_names)
    found = forces_of(phase, _method()).system
    assert "contact.rim.normal" in found.control_names
    assert system.control_names == before


@pytest.mark.parametrize("way", WAYS)
def test_a_puck_brakes_by_its_friction(way: str) -> None:
    solution = solve(pucks.sliding(speed=1.2, discretisation=way))
    h = 0.06
    speeds = np.maximum(1.2 - FRICTION * G * h * np.arange(11), 0.0)
    assert _series(solution, "states", "d(x)") == pytest.approx(speeds, abs=1e-6)
    pushes = np.minimum(FRICTION * G, speeds[:-1] / h)
    assert _series(solution, "forces", "contact.rim.tangential_x") == pytest.approx(
        -pushes, abs=1e-5
    )
    assert _series(solution, "forces", "contact.rim.normal") == pytest.approx(G, abs=1e-6)
    assert solution.mode_sequence is not None
    words = [mode.contacts["rim"] for mode in solution.mode_sequence.modes]
    assert words == ["sliding", "sticking"]


def test_results_have_forces_and_impulses_and_no_slacks() -> None:
    solution = solve(pucks.sliding(directions=8))
    groups = solution.phases[0].groups
    names = [f"contact.rim.{word}" for word in ("normal", "tangential_x", "tangential_y")]
    assert list(groups["forces"].values) == names
    assert list(groups["impulses"].values) == names
    assert groups["controls"].values == {}
    assert solution.static == {}


def test_the_cone_of_many_directions_is_round() -> None:
    """Away from the way under a round cone, over all that a puck turns: less at every doubling."""
    away = [np.mean([_strayed(count, turn) for turn in TURNS]) for count in (4, 8, 16, 32)]
    falls = np.divide(away[:-1], away[1:])
    assert np.all(falls > 2), away
    assert away[0] / away[-1] > 4 * 4 * 2, away


@pytest.mark.parametrize("way", WAYS)
def test_a_slider_comes_to_rest_on_its_stop(way: str) -> None:
    solution = solve(pucks.falling(discretisation=way))
    height = _series(solution, "states", "z")
    assert height.min() == pytest.approx(-0.1, abs=1e-7)
    assert height[-1] == pytest.approx(-0.1, abs=1e-7)
    effort = _series(solution, "forces", "limit.z")
    assert effort[0] == pytest.approx(0.0, abs=1e-6)
    assert effort[-1] == pytest.approx(G, abs=1e-6)
    impulse = _series(solution, "impulses", "limit.z")
    assert impulse.sum() == pytest.approx(G * 0.6, abs=1e-6), "all that gravity gave"


@pytest.mark.parametrize(
    "method",
    [
        {"steps": "pairwise"},
        *({"relaxation": {"form": form}} for form in ("inequality", "summed", "penalty")),
        {"relaxation": {"form": "fischer_burmeister"}},
    ],
    ids=str,
)
def test_every_relaxation_and_free_steps_lead_to_the_same_rolling(
    method: dict[str, object],
) -> None:
    solution = solve(pucks.ball(segments=12, directions=6, **method))
    assert solution.status is SolutionStatus.CONVERGED, solution.message
    assert _series(solution, "states", "base.d(x)")[-1] == pytest.approx(0.6 * 5 / 7, rel=2e-3)


def test_only_backward_euler_fails_the_audit_of_a_rolling_ball() -> None:
    verdicts = {
        way: solve(pucks.ball(segments=12, discretisation=way)).certificate.verdict for way in WAYS
    }
    assert verdicts == {"discrete_gradient": "certified", "backward_euler": "not_certified"}


def test_without_stops_limits_are_bounds() -> None:
    phase = pucks.falling().phases[0]
    found = forces_of(phase, _method(stops=False))
    assert found.pairs == []


@pytest.mark.parametrize("way", WAYS)
def test_a_ball_slides_and_rolls(way: str) -> None:
    """A solid ball rolls at 5/7 of its first speed, whatever the friction."""
    solution = solve(pucks.ball(segments=24, directions=16, discretisation=way))
    assert solution.mode_sequence is not None
    words = [mode.contacts["cloth"] for mode in solution.mode_sequence.modes]
    assert words == ["sliding", "sticking"]
    norm = sum(_series(solution, "states", f"base.{one}") ** 2 for one in ("qw", "qx", "qy", "qz"))
    assert norm == pytest.approx(1.0, abs=1e-7)
    height = _series(solution, "states", "base.z")
    assert height == pytest.approx(RADIUS, abs=1e-7)
    speed = np.hypot(*(_series(solution, "states", f"base.d({one})") for one in "xy"))
    assert speed[-1] == pytest.approx(5 / 7, rel=0.01)


def test_what_may_not_slip_stays_or_cannot_be() -> None:
    weak, strong = (FRICTION * G * share for share in (0.5, 1.5))
    stays = solve(pucks.sliding(speed=0.0, wind=weak, friction="no_slip", segments=5))
    assert _series(stays, "states", "y") == pytest.approx(0.0, abs=1e-9)
    assert _series(stays, "forces", "contact.rim.tangential_y") == pytest.approx(-weak, abs=1e-6)
    slides = solve(pucks.sliding(speed=0.0, wind=strong, segments=5))
    assert slides.status is SolutionStatus.CONVERGED, slides.message
    blown = solve(pucks.sliding(speed=0.0, wind=strong, friction="no_slip", segments=5))
    assert blown.status is not SolutionStatus.CONVERGED


def _strayed(count: int, turn: float) -> float:
    """How far the end is from that under a round cone, by the same steps; m."""
    method = {"directions": count, "segments": 20, "discretisation": "backward_euler"}
    solution = solve(pucks.sliding(speed=2.0, wind=2.0, turn=turn, **method))
    there = [_series(solution, "states", axis)[-1] for axis in "xy"]
    c, s = np.cos(turn), np.sin(turn)
    return float(np.hypot(*(np.array([[c, -s], [s, c]]) @ _round(2.0, 20) - there)))


def _round(wind: float, steps: int) -> Array:
    """Where steps of backward Euler end under a round cone."""
    v, x = np.array([2.0, 0.0]), np.zeros(2)
    h = 0.6 / steps
    for _ in range(steps):
        before = v

        def left(after: Array, before: Array = before) -> Array:
            push = np.array([0.0, wind]) - FRICTION * G * after / np.linalg.norm(after)
            return after - before - h * push

        v = root(left, before, tol=1e-12).x
        x = x + h * v
    return x


def _method(**changed: object) -> ContactImplicit:
    return ContactImplicit.model_validate(
        {"kind": "contact_implicit", "discretisation": "backward_euler", **changed}
    )


def _series(solution: Solution, group: str, name: str) -> Array:
    return np.array(solution.phases[0].groups[group].values[name], dtype=float)
