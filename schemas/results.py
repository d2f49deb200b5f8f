"""What a solve returns: trajectories, mesh diagnostics and the certificate.

Sizes: a series has one number per time of its group; a curve has one row of Chebyshev
coefficients per segment. Units are SI throughout.
"""

import math
from enum import StrEnum
from typing import Literal

from pydantic import Field

from schemas.base import Strict
from schemas.frames import Frames

FORMAT = 1
"""The version of this result format; it grows when a field changes its meaning."""


def finite(value: float) -> float | None:
    """A number for JSON: NaN and infinities are null."""
    return float(value) if math.isfinite(value) else None


class SolutionStatus(StrEnum):
    """How the mathematics ended. ``converged`` means optimal, meshed and certified."""

    CONVERGED = "converged"
    ACCEPTABLE = "acceptable"
    CERTIFICATE_FAILED = "certificate_failed"
    LOCALLY_INFEASIBLE = "locally_infeasible"
    DIVERGED = "diverged"
    UNBOUNDED = "unbounded"
    ITERATION_LIMIT = "iteration_limit"
    TIME_LIMIT = "time_limit"
    CANCELLED = "cancelled"
    INVALID_NUMBER = "invalid_number"
    MESH_LIMIT = "mesh_limit"
    COMPLEMENTARITY_STALLED = "complementarity_stalled"


class Group(Strict):
    """Series on their common times: the values at the nodes of the transcription."""

    time: list[float]
    values: dict[str, list[float | None]]


class CurveGroup(Strict):
    """Piecewise polynomials on common breaks, the method's own interpolant.

    On the segment from ``breaks[k]`` to ``breaks[k+1]`` a series is the sum over j of
    ``coefficients[name][k][j] * T_j(s)``, where s runs from -1 to 1 over the segment and T_j is
    the Chebyshev polynomial of the first kind (well conditioned at any degree). Null where the
    model had no finite value.
    """

    breaks: list[float]
    coefficients: dict[str, list[list[float | None]]]


class PhaseResult(Strict):
    """One phase: its knots, node values by group, and continuous curves by group.

    Groups: ``states``, ``controls``; ``rates``, where derivatives of controls are series of their
    own; ``forces`` of contacts and loops; ``costates``, of the continuous problem, at the times at
    which the method knows them. ``frames``: where the bodies of a mechanism are, for drawing.
    """

    name: str
    knots: list[float]
    groups: dict[str, Group]
    curves: dict[str, CurveGroup]
    integrals: dict[str, float | None] = Field(default_factory=dict)
    frames: Frames | None = None


class MeshIteration(Strict):
    """One mesh of the refinement. ``errors`` has one entry per segment, as has ``spans``."""

    segments: int
    max_error: float | None
    errors: list[float | None]
    spans: list[tuple[float, float]]
    objective: float | None
    nlp_iterations: int
    seconds: float
    status: str
    degrees: list[int] = Field(default_factory=list)
    switches: list[float] = Field(default_factory=list)


class MeshRefinement(Strict):
    """The history of the mesh. ``tolerance`` is null where refinement was off."""

    tolerance: float | None
    converged: bool
    iterations: list[MeshIteration]


class Check(Strict):
    """One check of the certificate. ``judged`` false: reported, without a say in the verdict."""

    name: str
    value: float | None
    tolerance: float | None
    unit: str
    passed: bool
    judged: bool
    where: str | None = None


class Certificate(Strict):
    """The independent judgement of the published curves against the problem's own text."""

    verdict: Literal["certified", "not_certified", "not_checked"]
    checks: list[Check]
    note: str = (
        "The certificate shows that the published curves satisfy the stated problem. "
        "It does not prove optimality: a minimum is a local one."
    )


class Residual(Strict):
    """A violated constraint: its group's name, phase and time, the violation in its own unit.

    ``value`` is null where the constraint has no finite value.
    """

    name: str
    phase: str | None
    time: float | None
    value: float | None


class SolverReport(Strict):
    """What the NLP solver did on the mesh that is published.

    ``residuals`` are ranked, the worst first; ``seconds`` were spent inside of the NLP solver.
    ``strategy`` is the one that gave the result, ``attempts`` says how those before it ended.
    """

    backend: str
    iterations: int
    status: str
    residuals: list[Residual]
    strategy: str = "default"
    attempts: list[str] = Field(default_factory=list)
    seconds: float = 0.0
    variables: int
    constraints: int


class StageReport(Strict):
    """One stage of several that were solved in a row, each from the one before."""

    status: SolutionStatus
    objective: float | None
    nlp_iterations: int
    segments: int
    seconds: float


class Minimum(Strict):
    """One of the distinct minima that several guesses led to. ``seeds`` found it."""

    objective: float | None
    status: SolutionStatus
    verdict: Literal["certified", "not_certified", "not_checked"]
    seeds: list[int]
    static: dict[str, float | None] = Field(default_factory=dict)
    phases: list[PhaseResult]


class Timing(Strict):
    """Wall-clock seconds of each part; they add up to ``total`` but for bookkeeping."""

    build: float
    solve: float
    refine: float
    certify: float
    total: float


class Reproduce(Strict):
    """What is needed to compute this again."""

    spec_sha256: str
    versions: dict[str, str]
    seed: int | None = None


class ModeSpan(Strict):
    """What touches from ``start`` to ``end``, in seconds, and how; contacts left out are open."""

    start: float
    end: float
    contacts: dict[str, str]


class ModeSequence(Strict):
    """When which contacts touch, in order of time; under contact-implicit methods limits, too.

    ``distinct`` counts the different modes, ``possible`` is how many there are. Under hybrid
    methods modes differ by what touches: 2 to the number of contacts. Under contact-implicit ones
    also by how: a contact is free, sticking, sliding_left or sliding_right (in space: sliding;
    frictionless where it has none), a limit ``limit.JOINT`` free, lower or upper; these multiply.
    """

    contacts: list[str]
    modes: list[ModeSpan]
    distinct: int
    possible: int


class HomotopyPass(Strict):
    """One solve of a relaxed contact problem. ``residual`` is the largest product of a pair."""

    relaxation: float
    form: str
    status: str
    nlp_iterations: int
    objective: float | None
    residual: float | None
    seconds: float


class Complementarity(Strict):
    """How contacts were brought to strict complementarity on the mesh that is published.

    ``residual``, in SI units, is recomputed from states and forces: the largest
    ``min(a, b)`` of a pair, m, m/s or N over the weight. ``stationarity`` is the kind of
    stationary point that the multipliers of the polished solve prove: strong, M, C, weak;
    null where there was no polish. ``pinned`` pairs had their gap fixed by the ends and took the
    inequality. ``dissipation`` is the energy that steps outside of impacts lose by the method, over
    the actuators' work; null where these do none.
    """

    form: str
    passes: list[HomotopyPass]
    polished: bool
    residual: float | None
    stationarity: str | None = None
    pinned: int = 0
    dissipation: float | None = None


class Solution(Strict):
    """A finished solve. An infeasible problem, too, is a solution with a status."""

    format: int = FORMAT
    name: str
    status: SolutionStatus
    objective: float | None
    message: str
    advice: list[str] = Field(default_factory=list)
    warnings: list[str] = Field(default_factory=list)
    static: dict[str, float | None] = Field(default_factory=dict)
    phases: list[PhaseResult]
    stages: list[StageReport] = Field(default_factory=list)
    minima: list[Minimum] = Field(default_factory=list)
    mode_sequence: ModeSequence | None = None
    guessed_sequence: ModeSequence | None = None
    complementarity: Complementarity | None = None
    mesh_refinement: MeshRefinement
    certificate: Certificate
    solver: SolverReport
    timing: Timing
    reproduce: Reproduce
