"""Parameters of the affinity between objects from many motion hypotheses, and of their drawing."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class ObjectHypothesisParams(Frozen):
    """Motion hypotheses of the whole frame, the objects' residuals under them, and the resulting preferences."""

    num_hypotheses: Annotated[int, Unit.COUNT] = Field(
        200,
        ge=10,
        description="hypotheses of each frame pair: of flow models from patches, or of each point model from tracks",
    )
    block: Annotated[int, Unit.PIXELS] = Field(
        8, ge=2, description="side of the square blocks of patches of flow, in pixels that are read"
    )
    min_patch: Annotated[int, Unit.COUNT] = Field(
        2, ge=1, description="shorter side of the smallest patches, in blocks"
    )
    elongation: Annotated[float, Unit.RATIO] = Field(
        2.7, ge=1, description="maximal ratio of the sides of a patch before it is clipped"
    )
    background_rows: Annotated[int, Unit.COUNT] = Field(3, ge=1, description="rows of cells of the background")
    background_columns: Annotated[int, Unit.COUNT] = Field(4, ge=2, description="columns of cells of the background")
    window: Annotated[float, Unit.SHARE] = Field(
        0.2, gt=0, le=1, description="share of a pair's hypotheses that an object prefers"
    )
    noise_floor: Annotated[float, Unit.PIXELS] = Field(
        0.1, ge=0, description="residual below which hypotheses explain flow equally well, px; flow models only"
    )
    scale_quantile: Annotated[float, Unit.SHARE] = Field(
        0.5,
        ge=0,
        le=1,
        description="quantile over the background's cells of the affinity to the most similar cell: its unit",
    )
