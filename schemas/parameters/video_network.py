"""Parameters of the network that is trained on the video itself."""

from typing import Annotated, Literal

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class VideoNetworkParams(Frozen):
    """Labels that are sure by motion, the training of a small network on them, and the weight of what it finds.

    Lengths in px refer to the working grid.
    """

    use: Literal["never", "always"] = Field(
        "never",
        description="whether a network is trained on each stretch of the video and added to the foreground of saliency;"
        " needs torch",
    )
    stretch_length: Annotated[int, Unit.FRAMES] = Field(
        120, ge=1, description="frames that share a network, in whole sections; a rest below half joins the last one"
    )

    sure_moving: Annotated[float, Unit.PROBABILITY] = Field(
        0.8, ge=0.5, lt=1, description="probability to move above which a pixel may be labelled as moving"
    )
    sure_static: Annotated[float, Unit.PROBABILITY] = Field(
        0.2, gt=0, le=0.5, description="probability to move below which a pixel is labelled as static"
    )
    near: Annotated[int, Unit.PIXELS] = Field(
        5, ge=0, description="largest distance of a moving label from a component that is kept, px"
    )
    proof_percentile: Annotated[float, Unit.PERCENT] = Field(
        80.0, ge=0, le=100, description="percentile of the proof of motion over these pixels that stands for certainty"
    )
    proof_share: Annotated[float, Unit.SHARE] = Field(
        0.4, ge=0, le=1, description="share of it that a pixel needs to be labelled as moving"
    )
    max_deviation: Annotated[float, Unit.RATIO] = Field(
        1.5,
        gt=0,
        description="deviation from the own motion, in its spreads, above which no pixel is labelled as moving",
    )
    min_proof: Annotated[float, Unit.NATS] = Field(
        0.1, gt=0, description="percentile of the proof below which nothing is sure to move, and no network is trained"
    )

    steps: Annotated[int, Unit.COUNT] = Field(120, ge=1, description="steps of training")
    crops: Annotated[int, Unit.COUNT] = Field(4, ge=1, description="crops of a step")
    crop_height: Annotated[int, Unit.PIXELS] = Field(160, ge=16, multiple_of=8, description="height of a crop, px")
    crop_width: Annotated[int, Unit.PIXELS] = Field(288, ge=16, multiple_of=8, description="width of a crop, px")
    learning_rate: Annotated[float, Unit.RATIO] = Field(
        2e-3, gt=0, description="largest learning rate of the one-cycle schedule"
    )
    min_zoom: Annotated[float, Unit.RATIO] = Field(0.8, gt=0, description="smallest enlargement of a crop")
    max_zoom: Annotated[float, Unit.RATIO] = Field(1.5, gt=0, description="largest enlargement of a crop")
    colour_gain: Annotated[float, Unit.RATIO] = Field(
        0.25, ge=0, lt=1, description="largest change of the contrast of L, a and b of a crop"
    )
    colour_shift: Annotated[float, Unit.RATIO] = Field(
        0.15, ge=0, description="sigma of the shift of L, a and b of a crop, of their range in the network's input"
    )
    max_noise: Annotated[float, Unit.RATIO] = Field(
        0.1, ge=0, description="largest sigma of the noise added to a crop, of the same range"
    )

    check_step: Annotated[int, Unit.FRAMES] = Field(
        4, ge=1, description="spacing of the frames over which the trained network's output is measured"
    )
    weight: Annotated[float, Unit.RATIO] = Field(
        0.7, ge=0, description="weight of the network's logit, in spreads, in that of the foreground"
    )
    caution: Annotated[float, Unit.SHARE] = Field(
        0.5, ge=0, le=2, description="share of the measured centre that is subtracted from the network's logit"
    )
    limit: Annotated[float, Unit.RATIO] = Field(
        3.0, gt=0, description="largest logit that counts, in spreads from its centre"
    )
    max_growth: Annotated[float, Unit.RATIO] = Field(
        1.5,
        gt=0,
        description="area that the network finds, relative to that of the components, above which its weight shrinks"
        " with the square of the excess",
    )
