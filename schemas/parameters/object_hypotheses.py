"""Parameters of the affinity between objects from many hypotheses of motion, and of how these are drawn."""

from pydantic import Field

from schemas.frozen import Frozen


class ObjectHypothesisParams(Frozen):
    """Motion hypotheses of the whole frame, the objects' residuals under them, and the preferences that these show."""

    num_hypotheses: int = Field(
        200, ge=10, description="drawn in each frame pair: flow models of patches; of tracks as many of each model"
    )
    block: int = Field(
        8, ge=2, description="side of the squares that patches of flow are made of, in pixels that are read"
    )
    min_patch: int = Field(2, ge=1, description="shorter side of the smallest patches, in blocks")
    elongation: float = Field(2.7, ge=1, description="greatest ratio of the sides of a patch before it is cut off")
    background_rows: int = Field(3, ge=1, description="rows of cells that the background is cut into")
    background_columns: int = Field(4, ge=2, description="columns of cells that the background is cut into")
    window: float = Field(0.2, gt=0, le=1, description="share of a pair's hypotheses that an object prefers")
    noise_floor: float = Field(
        0.1, ge=0, description="residual below which hypotheses explain flow equally well, px; flow models only"
    )
    scale_quantile: float = Field(
        0.5,
        ge=0,
        le=1,
        description="quantile over the background's cells of how alike each is to another: counts as the same motion",
    )
