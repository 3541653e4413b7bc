"""The picture that black bars surround: geometry counts its pixels, because the camera's axis meets its middle."""

from collections.abc import Mapping

import numpy as np

from moseg.schemas.black_bars import BlackBars
from moseg.workflows.stages.inputs import Inputs
from moseg.workflows.stages.moving_tracks import tracks_of


def bars_params(bars: BlackBars | None) -> dict:
    """Return the parameters of a recipe that name the bars; none without bars, so that such a recipe stays as it is."""
    return {} if bars is None else {"bars": bars._asdict()}


def bars_of(params: Mapping) -> BlackBars:
    """Return the bars that parameters of a recipe name."""
    return BlackBars(**params.get("bars", {}))


def tracks_in_picture(inputs: Inputs, bars: BlackBars) -> tuple[np.ndarray, np.ndarray]:
    """Return a window's tracks as `tracks_of` does, but in px of the picture; the points that are not seen are any."""
    points, visible = tracks_of(inputs)
    return (points - np.float32(bars.corner) if any(bars) else points), visible
