"""What every transcription promises (``solver.transcriptions.base``), whichever it is."""

from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter

from footfall.curves import Curves
from schemas.methods import Method
from schemas.results import SolutionStatus
from solver.expressions import SX
from solver.transcriptions import Transcription, make_transcription
from solver.transcriptions.base import Point, Segment
from tests.support.methods import label, variants
from tests.unit.solver.problems import block, solved


@pytest.fixture(params=variants(), ids=label)
def method(request: pytest.FixtureRequest) -> dict[str, Any]:
    return dict(request.param)


@pytest.fixture
def transcription(method: dict[str, Any]) -> Transcription:
    return make_transcription(TypeAdapter(Method).validate_python(method))


def test_nodes_run_from_knot_to_knot(transcription: Transcription) -> None:
    first, *_, last = transcription.nodes
    assert (first.fraction, last.fraction) == (0, 1)
    assert np.all(np.diff(transcription.fractions) > 0)


def test_the_knots_carry_states_and_controls(transcription: Transcription) -> None:
    """Neighbours share the states; the controls where the transcription says so."""
    first, *_, last = transcription.nodes
    assert all((first.state, last.state, last.control))
    assert first.control == transcription.shares_controls


def test_the_quadrature_integrates_a_straight_line(transcription: Transcription) -> None:
    points = tuple(
        Point(SX.zeros(int(node.state)), SX.zeros(int(node.control)), SX(0, 1), SX(node.fraction))
        for node in transcription.nodes
    )
    segment = Segment(points, SX(1), lambda point: SX.zeros(point.x.shape), lambda *_: SX(0, 1))
    quadrature = transcription.collocate(segment).quadrature
    assert sum(weight for weight, _ in quadrature) == pytest.approx(1)
    assert sum(weight * float(point.t) for weight, point in quadrature) == pytest.approx(1 / 2)


def test_constraints_over_the_ends_hold_on_the_curves_through_the_nodes(
    method: dict[str, Any],
) -> None:
    rows = [
        {"name": side, "expression": f"{side}.u", "lower": value, "upper": value}
        for side, value in (("initial", 5), ("final", -4))
    ]
    document = block(phase={"boundary": rows}, method={**method, "segments": 8}, refinement=None)
    solution = solved(document | {"certificate": {"tolerance": 0.1}})
    assert solution.status is SolutionStatus.CONVERGED
    (phase,) = solution.phases
    ends = [phase.groups["controls"].values["u"][at] for at in (0, -1)]
    assert ends == pytest.approx([5, -4], abs=1e-6)
    for name, published in phase.curves.items():
        curves, group = Curves.from_dict(published.model_dump()), phase.groups[name]
        for series, values in group.values.items():
            assert curves[series](group.time) == pytest.approx(values, abs=1e-7)
