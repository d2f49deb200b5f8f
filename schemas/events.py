"""What happens during a job, as it happens. Events go to terminals, SSE streams and logs."""

from typing import Annotated, Literal

from pydantic import Field, TypeAdapter

from schemas.base import Strict


class StageStarted(Strict):
    """The pipeline entered a stage, or begins it anew; ``note`` says why."""

    type: Literal["stage"] = "stage"
    stage: Literal["build", "solve", "refine", "certify", "simulate"]
    note: str = ""


class NlpIteration(Strict):
    """One iteration of the NLP solver on mesh ``mesh`` (from 0). Violation is in scaled rows."""

    type: Literal["nlp_iteration"] = "nlp_iteration"
    mesh: int
    iteration: int
    objective: float | None
    violation: float | None
    seconds: float


class MeshSolved(Strict):
    """One mesh was solved and its error estimated."""

    type: Literal["mesh"] = "mesh"
    mesh: int
    segments: int
    max_error: float | None
    tolerance: float | None
    objective: float | None
    nlp_iterations: int
    seconds: float


class PassSolved(Strict):
    """One pass of a homotopy: a contact problem solved at one relaxation on mesh ``mesh``."""

    type: Literal["homotopy"] = "homotopy"
    mesh: int
    relaxation: float
    form: str
    status: str
    nlp_iterations: int
    objective: float | None
    residual: float | None
    seconds: float


class Advanced(Strict):
    """A simulation has come to ``time`` of ``end``, in s of the motion; ``events`` happened."""

    type: Literal["advance"] = "advance"
    time: float
    end: float
    events: int = 0


class PointEnded(Strict):
    """One point of a sweep has ended. ``index`` counts from 0 over the whole sweep."""

    type: Literal["point"] = "point"
    index: int
    status: str
    solution_status: str | None = None
    objective: float | None = None
    seconds: float = 0.0


class StateChanged(Strict):
    """The job moved to another state. ``terminal`` ends the stream."""

    type: Literal["state"] = "state"
    status: str
    terminal: bool
    attempt: int = 0
    message: str = ""


Event = Annotated[
    StageStarted | NlpIteration | MeshSolved | PassSolved | Advanced | PointEnded | StateChanged,
    Field(discriminator="type"),
]
EngineEvent = StageStarted | NlpIteration | MeshSolved | PassSolved | Advanced
event_adapter: TypeAdapter[Event] = TypeAdapter(Event)
