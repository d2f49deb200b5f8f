"""The published table of limits, read from where each of them is enforced."""

from pydantic import BaseModel, Field

from api.settings import ApiSettings
from api.trajectory import MAX_VALUES
from schemas.expressions.tokens import MAX_CONSTANT, MAX_DEPTH, MAX_LENGTH, MAX_NODES
from schemas.limits import MODEL_LIMITS, ModelLimits
from schemas.simulations.document import MAX_GUARDS, MAX_SAMPLES


class ServiceLimits(BaseModel):
    """What one request, one problem and one owner may ask for, at the most."""

    body_bytes: int
    seconds: float = Field(description="Of one job; who asks for more gets this.")
    megabytes: int = Field(description="Of one job; who asks for more gets this.")
    waiting_jobs: int = Field(description="Per owner.")
    trajectory_samples: int = Field(description="Times per phase of one answer.")
    trajectory_values: int = Field(description="Numbers in one answer.")
    simulation_samples: int = Field(description="Times at which a simulation lists its series.")
    simulation_events: int = Field(description="Guards of one simulation.")
    expression_characters: int
    expression_depth: int
    expression_nodes: int
    expression_constant: float
    model: ModelLimits


def limits(settings: ApiSettings) -> ServiceLimits:
    """The limits under these settings."""
    return ServiceLimits(
        body_bytes=settings.body_bytes,
        seconds=settings.max_seconds,
        megabytes=settings.max_megabytes,
        waiting_jobs=settings.max_waiting_jobs,
        trajectory_samples=settings.max_samples,
        trajectory_values=MAX_VALUES,
        simulation_samples=MAX_SAMPLES,
        simulation_events=MAX_GUARDS,
        expression_characters=MAX_LENGTH,
        expression_depth=MAX_DEPTH,
        expression_nodes=MAX_NODES,
        expression_constant=MAX_CONSTANT,
        model=MODEL_LIMITS,
    )
