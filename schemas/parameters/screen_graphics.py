"""Parameters of the search for graphics that were drawn into a video's frames."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class ScreenGraphicsParams(Frozen):
    """Edges that do not move at all, in almost all frames of a user's video, while the scene moves behind them.

    Such graphics are filled for the analysis; the sequences of data sets are not searched.
    """

    fill: bool = Field(
        True,
        description="whether graphics are left out: filled for the analysis with what is around them; if not, they are "
        "only named, and analysed as scene",
    )
    side: Annotated[int, Unit.PIXELS] = Field(
        854, ge=64, description="longer side at which larger frames are searched, to which other lengths refer, px"
    )
    min_gradient: Annotated[float, Unit.GREY_LEVELS] = Field(
        6.0, gt=0, description="smallest median gradient of a pixel at an edge, grey levels per px"
    )
    tolerance: Annotated[float, Unit.SHARE] = Field(
        0.5, gt=0, lt=1, description="deviation of a frame's gradient from its median that still agrees, of the median"
    )
    noise: Annotated[float, Unit.GREY_LEVELS] = Field(
        2.0, ge=0, description="the same beside it, for noise and coding, grey levels per px"
    )
    min_agreement: Annotated[float, Unit.SHARE] = Field(
        0.9, gt=0.5, le=1, description="frames in which the gradient of a pixel agrees, at least"
    )
    min_edge: Annotated[int, Unit.PIXELS] = Field(
        20, ge=1, description="pixels at the edges of a graphic, at least, at the size that is searched"
    )
    max_shift: Annotated[float, Unit.PIXELS] = Field(
        0.2,
        gt=0,
        description="largest shift of a graphic's edges, in nine of ten frames: distant parts of a scene sway by more",
    )
    min_motion: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.5, ge=0, description="motion of the background from a frame to the next in which the camera moves, px/frame"
    )
    max_still: Annotated[float, Unit.SHARE] = Field(
        0.5,
        gt=0,
        le=1,
        description="edges of the frame that may stand still, where the camera moves in all frames; where it moves in "
        "a share of them, this times the square of that share. Else no edge is a graphic's, as what stands in front of "
        "a camera at rest could not be told from one",
    )
    join: Annotated[float, Unit.SHARE] = Field(
        0.01, gt=0, le=0.1, description="distance to which edges belong together, relative to the frame's longer side"
    )
    reach: Annotated[float, Unit.RATIO] = Field(
        0.5, ge=0, description="how far a plain ground of a graphic reaches beyond its edges, in its shorter sides"
    )
    steadiness: Annotated[float, Unit.SHARE] = Field(
        0.5, ge=0, lt=1, description="deviation of the colours of this ground over time, of that of the scene around it"
    )
    max_area: Annotated[float, Unit.SHARE] = Field(
        0.3, gt=0, lt=1, description="largest area of all graphics, relative to the frame; else there are none"
    )
    num_frames: Annotated[int, Unit.FRAMES] = Field(
        16, ge=2, description="frames that are compared, spread over the video from its first to its last"
    )
