"""Parameters of object-specific point tracks."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.choices import ChoiceOf
from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class TrackParams(Frozen):
    """Points sampled in every object and tracked through a section."""

    method: Annotated[str, ChoiceOf("tracks.method")] = Field(
        "lucas-kanade", description="point tracker, exact tracks of the data set, or a folder"
    )
    points_per_object: Annotated[int, Unit.COUNT] = Field(60, ge=8, description="number of points in each object")
    background_points: Annotated[int, Unit.COUNT] = Field(
        160, ge=8, description="number of points in the background, spread over the frame"
    )
    resample_every: Annotated[int, Unit.FRAMES] = Field(
        8,
        ge=1,
        description="frames between checks of a point against its object's mask, at which new points are sampled; with"
        " pips 7 at most; with bootstapir each frame is checked, and new points are sampled every so often",
    )
    border: Annotated[int, Unit.PIXELS] = Field(
        6, ge=0, description="points nearer than this to the frame's border are removed, px"
    )
    corner_fraction: Annotated[float, Unit.SHARE] = Field(
        0.7, ge=0, le=1, description="share of the points that are Shi-Tomasi corners; the others are k-medoids"
    )
    corner_quality: Annotated[float, Unit.SHARE] = Field(
        0.01, ge=0, le=1, description="minimal corner response, as a share of the largest one inside the object"
    )
    spread: Annotated[float, Unit.SHARE] = Field(
        0.25,
        ge=0,
        description="minimal distance of sampled corners, as a share of the spacing of an even grid",
    )
    medoid_candidates: Annotated[int, Unit.COUNT] = Field(
        300, ge=8, description="random pixels of an object among which medoids are chosen"
    )
    erosion: Annotated[int, Unit.PIXELS] = Field(
        3, ge=0, description="erosion of an object before sampling, px, unless it removes the whole object"
    )
    window: Annotated[int, Unit.PIXELS] = Field(15, ge=5, le=255, description="side of the Lucas-Kanade window, px")
    pyramid_levels: Annotated[int, Unit.COUNT] = Field(4, ge=0, description="pyramid levels above full resolution")
    forward_backward: Annotated[float, Unit.PIXELS] = Field(
        1.0, gt=0, description="maximal forward-backward error of a tracked point, px"
    )
