"""Parameters of the motion affinity between objects."""

from typing import Annotated, Literal

from pydantic import Field, field_validator

from moseg.schemas.choices import ChoiceOf
from moseg.schemas.frozen import Frozen
from moseg.schemas.parameters.comma_separated import check_models, split_commas
from moseg.schemas.units import Unit


class AffinityParams(Frozen):
    """Conversion of pairwise residuals into affinities."""

    method: Annotated[str, ChoiceOf("affinity.method")] = Field(
        "residual",
        description="residual size, the paper's weighted ORK, ORK over many hypotheses (hypotheses), or residual size"
        " and many hypotheses together (combined)",
    )
    ork_threshold: Annotated[int, Unit.COUNT] = Field(
        2, ge=1, description="t of the weighted ORK: number of smallest residuals that score"
    )
    ork_reading: Literal["models", "objects"] = Field(
        "models", description="rank the models for each object's data, or the objects under each model"
    )
    scale: Annotated[float, Unit.PIXELS] = Field(
        0.5, gt=0, description="residual size at which affinity falls to exp(-1/2), px"
    )
    relative: Annotated[float, Unit.SHARE] = Field(
        1.0, ge=0, description="share of both objects' residuals under their own models added to the scale, in squares"
    )
    relative_flow: Annotated[float, Unit.SHARE] = Field(
        0.05, ge=0, description="share of the object's flow length added to the scale, in squares; flow models only"
    )
    excess: bool = Field(
        True, description="subtract an object's residual under its own model from those under other models"
    )
    direction: Literal["background", "min", "mean", "max"] = Field(
        "background",
        description=(
            "which of the two residuals of a pair of objects counts: the smaller, their mean, the larger, or "
            "(background) that under the background's model if one of the two is the background, else the smaller"
        ),
    )
    quantile: Annotated[float, Unit.SHARE] = Field(
        0.5, ge=0, le=1, description="quantile over frame pairs of the distance between two objects"
    )
    static_pairs: Annotated[int, Unit.COUNT] = Field(
        16,
        ge=2,
        description="frame pairs in a row over which the quantile is taken for the support as static, of which the run "
        "with the least support counts: an object that rests for long has moved",
    )


class HypothesisAffinityParams(Frozen):
    """Affinity of objects from many motion hypotheses, each drawn from the tracks of a few objects."""

    models: tuple[Annotated[str, ChoiceOf("clustering.count.affinity.models")], ...] = Field(
        ("homography", "fundamental"),
        min_length=1,
        description="point models of two frames, the models of the hypotheses",
    )
    gap: Annotated[int, Unit.FRAMES] = Field(
        3,
        ge=1,
        description="frames between the two frames of a pair; where motions are counted, that of the counting is read",
    )
    num_hypotheses: Annotated[int, Unit.COUNT] = Field(
        300, ge=1, description="minimal samples of each model in each frame pair"
    )
    num_objects: Annotated[int, Unit.COUNT] = Field(
        3, ge=1, description="random objects from whose tracks a sample is drawn"
    )
    min_tracks: Annotated[int, Unit.COUNT] = Field(
        4, ge=1, description="visible tracks below which an object is ignored in a pair, unless it has no more"
    )
    window: Annotated[float, Unit.SHARE] = Field(
        0.075, gt=0, le=1, description="share of a pair's hypotheses that an object prefers"
    )
    fade: Annotated[float, Unit.RATIO] = Field(
        10.0,
        ge=0,
        description="residual at which a preference counts half, in units of a typical object's residual under good"
        " hypotheses; 0: only ranks count",
    )
    fusion: Literal["product", "sum"] = Field(
        "product", description="geometric or arithmetic mean of the models' cosines between preferences"
    )
    power: Annotated[float, Unit.RATIO] = Field(5.0, gt=0, description="power of that mean")

    _split_models = field_validator("models", mode="before")(split_commas)
    _check_models = field_validator("models")(check_models)
