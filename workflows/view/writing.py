"""Writing of a result as corrected: what `moseg segment` and `moseg export` write."""

from pathlib import Path

from moseg.schemas.errors import InputError
from moseg.workflows.api.open_run import OpenVideo
from moseg.workflows.config.frame_range import read_step
from moseg.workflows.exports.overlay_style import OverlayMode, OverlayStyle
from moseg.workflows.view.opened import ExportChoices, Written

SIZES = ("analysed", "video")
NO_OVERLAY = "none"


def write_result(video: OpenVideo, out: Path, choices: ExportChoices, fps: float | None) -> Written:
    """Write masks, summary and what is chosen of the corrections in force.

    Parameters
    ----------
    fps : float or None
        Of images, for steps in seconds.

    Raises
    ------
    InputError
        Something is wrong in the choices, needs the video where that is not known, or cannot be written.
    """
    summary, paths = video.save(
        out,
        style=_read_style(choices),
        has_full_size=_is_full_size(choices),
        exports=choices.formats,
        dilation=choices.dilate,
        num_frames=video.num_frames,
        sets=choices.sets,
        step=None if choices.every is None else read_step(choices.every, "--for-every"),
        fps=fps,
    )
    return Written(paths, summary.look_at)


def _read_style(choices: ExportChoices) -> OverlayStyle | None:
    if choices.overlay == NO_OVERLAY:
        return None
    if choices.overlay not in [*OverlayMode]:
        expected = " or ".join([*OverlayMode, NO_OVERLAY])
        raise InputError("no such overlay", where="overlay", got=repr(choices.overlay), expected=expected)
    return OverlayStyle(
        mode=OverlayMode(choices.overlay), is_side_by_side=choices.side_by_side, has_identities=choices.identities
    )


def _is_full_size(choices: ExportChoices) -> bool:
    if choices.overlay_size not in SIZES:
        got, expected = repr(choices.overlay_size), " or ".join(SIZES)
        raise InputError("no such size", where="overlay size", got=got, expected=expected)
    return choices.overlay_size == "video" and choices.overlay != NO_OVERLAY
