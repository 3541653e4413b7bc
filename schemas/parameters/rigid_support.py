"""Parameters of the support of objects for being part of the rigid scene, from the dense tracks in their masks."""

from typing import Annotated, Literal

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class RigidSupportParams(Frozen):
    """Comparison of an object with a rigid scene: of its tracks, and of its depth where it meets what is around it."""

    use: Literal["auto", "always", "never"] = Field(
        "auto",
        description="where objects are compared with a rigid scene: where they come from dense tracks, and in stretches"
        " whose depth shows by parallax, with --proposals auto or motion-prompts (auto), in the whole video (always) or"
        " nowhere (never)",
    )
    step: Annotated[int, Unit.FRAMES] = Field(
        4,
        ge=1,
        description="frames between the first frames of the pairs that compare objects of saliency with a rigid scene;"
        " objects of dense tracks are compared in all pairs",
    )
    max_test: Annotated[float, Unit.RATIO] = Field(
        0.6,
        ge=-1,
        le=3,
        description="largest mean strict test of rigidity of an object that a rigid scene explains",
    )
    min_observations: Annotated[int, Unit.COUNT] = Field(
        12,
        ge=1,
        description="observations of an object's tracks over frame pairs, those skipped by `step` included, below which"
        " nothing shows that it moves",
    )
    contour_distance: Annotated[float, Unit.PIXELS] = Field(
        14.0, gt=0, description="largest distance of tracks inside and outside an object whose depth is compared, px"
    )
    depth_slack: Annotated[float, Unit.SHARE] = Field(
        0.08, ge=0, description="difference of inverse depth of tracks that may lie on one surface"
    )
    min_contour: Annotated[float, Unit.COUNT] = Field(
        8.0,
        ge=0,
        description="tracks at an object's contour, in the mean over frame pairs, below which its tracks are compared"
        " with the depth of the whole scene instead, where as many others must have it",
    )
    min_attached: Annotated[float, Unit.SHARE] = Field(
        0.75,
        ge=0,
        le=1,
        description="share of tracks at the depth of others outside, below which the object stands free: its motion may"
        " be parallel to the camera's",
    )
