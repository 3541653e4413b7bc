"""Parameters of the training of the motion network on rendered scenes."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class NetworkTrainingParams(Frozen):
    """Training by AdamW with a cosine schedule; the moving average of the weights is the result."""

    scenes: Annotated[int, Unit.COUNT] = Field(4200, ge=1, description="rendered scenes to train on")
    validation_scenes: Annotated[int, Unit.COUNT] = Field(500, ge=1, description="rendered scenes to validate on")
    textures: Annotated[int, Unit.COUNT] = Field(256, ge=1, description="painted textures of the scenes")
    steps: Annotated[int, Unit.COUNT] = Field(7000, ge=1, description="steps of the optimizer")
    batch: Annotated[int, Unit.COUNT] = Field(8, ge=1, description="samples of a step")
    rate: Annotated[float, Unit.RATIO] = Field(2e-3, gt=0, description="largest learning rate")
    warm_up: Annotated[int, Unit.COUNT] = Field(200, ge=1, description="steps in which the rate grows to its largest")
    last_rate: Annotated[float, Unit.SHARE] = Field(
        0.005, ge=0, le=1, description="rate added at all steps, and so the last one, of the largest"
    )
    decay: Annotated[float, Unit.RATIO] = Field(1e-2, ge=0, description="decay of the weights of convolutions")
    average: Annotated[float, Unit.SHARE] = Field(
        0.998, ge=0, lt=1, description="share of the moving average that a step keeps"
    )
    missing: Annotated[float, Unit.PROBABILITY] = Field(
        0.06, ge=0, le=0.5, description="chance of each time direction to be missing, as at the ends of a video"
    )
    smoothing: Annotated[float, Unit.PROBABILITY] = Field(
        0.02, ge=0, lt=0.5, description="least probability that a label leaves to the opposite"
    )
    overlap: Annotated[float, Unit.RATIO] = Field(
        0.5, ge=0, description="weight of the soft intersection over union beside the cross-entropy"
    )
    gradient: Annotated[float, Unit.RATIO] = Field(1.0, gt=0, description="largest norm of the gradient")
    interval: Annotated[int, Unit.COUNT] = Field(250, ge=1, description="steps between validations and checkpoints")
