"""DirCol5i on short segments: its splines are the seed's, and their derivatives keep digits."""

from typing import Any

import casadi as ca
import numpy as np
import pytest

import examples
from footfall.curves import Curves
from schemas.results import SolutionStatus
from solver.expressions import SX
from solver.transcriptions.base import Collocation, Point, Segment
from solver.transcriptions.dircol5i import DirCol5i
from tests.unit.solver.problems import solved

SNAP_LIMITED = 124.1837  # numerics.md's table: 003, section 8.8, abs(u) <= 2
H = 0.3


def swing_up(objective: str, **changes: Any) -> dict[str, Any]:
    return examples.load(f"pendulum_{objective}_limited") | {"refinement": None} | changes


def collocated(start: list[float], higher: list[float], end: list[float]) -> Collocation:
    """A segment of one coordinate and one control at rest, in numbers."""
    jerk, snap, last = higher
    none, rest = SX(0, 1), SX.zeros(2)
    points = (
        Point(SX(ca.vertcat(*start)), rest, none, SX(0)),
        Point(none, none, none, SX(0), SX(ca.vertcat(jerk, snap))),
        Point(none, none, none, SX(0), SX(ca.vertcat(last))),
        Point(SX(ca.vertcat(*end)), rest, none, SX(H)),
    )
    return DirCol5i().collocate(Segment(points, SX(H), lambda point: point.x, lambda *_: none))


def numbers(values: SX) -> list[float]:
    return list(ca.evalf(values).full().ravel())


def test_the_spline_is_the_quintic_through_both_knots() -> None:
    """Where the defects vanish, 8.12's Hermite quintic gives the inner points, too."""
    start, higher = [0.3, -1.0, 2.0], [5.0, -40.0, 70.0]
    end = numbers(collocated(start, higher, [0.0, 0.0, 0.0]).defects)
    found = collocated(start, higher, end)
    assert numbers(found.defects) == pytest.approx([0, 0, 0], abs=1e-12)
    x = np.array([[numbers(point.x) for point in found.points]])
    curve = DirCol5i().state_curve(x, np.zeros_like(x), np.full((1, 1), H))
    curves = Curves([0.0, H], {name: curve[k] for k, name in enumerate(("q", "v", "a"))})
    times = [node.fraction * H for node in DirCol5i.nodes]
    for row, name in enumerate(curves):
        assert curves[name](times) == pytest.approx(x[0, :, row], abs=1e-12)
    jerk, snap = (curves["a"].derivative(order) for order in (1, 2))
    natives = np.array([numbers(point.natives) for point in found.points])
    assert jerk(times) == pytest.approx(natives[:, 0], abs=1e-9)
    assert snap(times) == pytest.approx(natives[:, 1], abs=1e-7)
    assert natives[1, :2] == pytest.approx(higher[:2])
    assert natives[2, 1] == pytest.approx(higher[2])


@pytest.mark.parametrize("segments", [200, 600])
def test_the_least_snap_on_short_segments(segments: int) -> None:
    """Its error falls with the square of their length, and is not lost in round-off."""
    method = {"kind": "dircol5i", "segments": segments}
    solution = solved(swing_up("snap", method=method))
    assert solution.status is SolutionStatus.CONVERGED, solution.message
    assert solution.solver.status == "Solve_Succeeded"
    error = 7.0 * SNAP_LIMITED / segments**2
    assert solution.objective == pytest.approx(SNAP_LIMITED + error, abs=0.3 * error)


def test_a_fast_motion_is_scaled() -> None:
    """The same swing-up a thousand times faster: derivatives of 1e9 and 1e12."""
    document = swing_up("jerk", method={"kind": "dircol5i", "segments": 40})
    (phase,) = document["phases"]
    phase["system"]["parameters"] = {"k": 3e6, "b": 2e2}
    phase["time"]["final"] = 5e-3
    phase["bounds"] = {"u": [-2e6, 2e6]}
    phase["integrals"] = {"jerk": "1e-15*ddd(q)^2"}
    slow = solved(swing_up("jerk", method=document["method"]))
    fast = solved(document)
    assert fast.status is SolutionStatus.CONVERGED, fast.message
    assert fast.objective == pytest.approx(slow.objective, rel=1e-7)
    assert not [line for line in fast.warnings if "dd(q)" in line], "users have no such variables"


@pytest.mark.parametrize(
    "method",
    [
        {"kind": "dircol5i", "segments": 12},
        {"kind": "chebyshev_lobatto", "segments": 1, "degree": 12},
        {"kind": "chebyshev_lobatto", "segments": 1, "degree": 16},
    ],
    ids=lambda method: "-".join(map(str, method.values())),
)
def test_the_least_snap_on_refined_meshes(method: dict[str, Any]) -> None:
    """Converged, certified and at the optimum; coarse meshes pass their limits and seem better."""
    solution = solved(swing_up("snap", method=method, refinement={"tolerance": 1e-6}))
    assert solution.status is SolutionStatus.CONVERGED, solution.message
    assert all(mesh.status == "optimal" for mesh in solution.mesh_refinement.iterations)
    assert solution.objective == pytest.approx(SNAP_LIMITED, rel=1e-5)
