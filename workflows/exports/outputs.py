"""Output folder of `moseg segment`: names of its files, and a check before the work that they can be written."""

import os
import re
from pathlib import Path

from moseg.schemas.errors import InputError
from moseg.workflows.exports.frame_origin import FrameOrigin
from moseg.workflows.exports.motion_json import read_motion
from moseg.workflows.exports.ownership import OwnedFile, is_own_mask, is_own_overlay, is_own_summary
from moseg.workflows.exports.write_text import check_folder, check_writable
from moseg.workflows.process.atomic_write import blame_output
from moseg.workflows.runlog.events import as_unicode

MASKS, OVERLAY, MOTION = "masks", "overlay.mp4", "motion.json"
PAGE_SUFFIXES = (".html", ".htm")
OWN_MASK = re.compile(r"\d{5,}\.png")
"""Names of the masks in their folder."""


def mask_name(index: int) -> str:
    """Return the file name of the mask of a frame, counted from 0."""
    return f"{index:05d}.png"


def check_outputs(folder: str, video: str | None, has_overlay: bool = True, argument: str = "--out") -> None:
    """Check the folder of a segmentation, which is created where it is absent.

    Parameters
    ----------
    folder : str
        In which ``masks/``, ``overlay.mp4`` and ``motion.json`` will be written.
    video : str or None
        Path of the video or of the folder of frames, where they came from one.
    has_overlay : bool
        Whether there will be an overlay; where not, a file of its name that is not moseg's own stays.
    argument : str
        Option or argument that names the folder.

    Raises
    ------
    InputError
        Nothing can be written there; the video itself would be overwritten; or a file would be replaced that moseg did
        not write, such as ground truth of the frames or a mask corrected by hand.
    """
    if not folder.strip():
        raise InputError("no output folder named", where=argument, got=repr(folder), expected="a folder")
    outputs = Path(folder)
    masks = outputs / MASKS
    with blame_output(outputs):
        for target in (masks, outputs / OVERLAY):
            if video is not None and target.exists() and os.path.exists(video) and target.samefile(video):
                raise InputError("the results would replace their input", where=target, expected=f"another {argument}")
    check_folder(outputs)
    for name in (OVERLAY, MOTION):
        check_writable(outputs / name)
    if masks.exists() and not masks.is_dir():
        raise InputError("cannot write", where=masks, got="a file", expected="a folder")
    with blame_output(masks):
        names = sorted(filter(OWN_MASK.fullmatch, os.listdir(masks))) if masks.is_dir() else []
    for name in names:
        OwnedFile(masks / name, is_own_mask).check()
    if has_overlay:
        OwnedFile(outputs / OVERLAY, is_own_overlay).check()
    OwnedFile(outputs / MOTION, is_own_summary).check()


def check_page(page: str, folder: Path) -> None:
    """Check that a page about a run is none of the results in `folder`.

    Results never have the suffix of a page. InputError is raised for another one in the folder.
    """
    is_inside = Path(os.path.realpath(page)).is_relative_to(os.path.realpath(folder))
    if is_inside and Path(page).suffix.lower() not in PAGE_SUFFIXES:
        expected = f"a name that ends with {PAGE_SUFFIXES[0]} in the folder of the results"
        raise InputError("a page that may replace a result", where="--report", got=page, expected=expected)


def check_same_video(folder: str, origin: FrameOrigin, name: str, argument: str = "--out") -> None:
    """Check that the results in a folder, if there are any, are those of the same video.

    Parameters
    ----------
    folder : str
        One that `check_outputs` has let pass.
    origin : FrameOrigin
        Its `identity` is that of the results; results or frames without one are known by `name`.
    name : str
        Of the video.
    argument : str
        Option or argument that names the folder.

    Raises
    ------
    InputError
        They are those of another video, or the video cannot be read.
    """
    summary = Path(folder) / MOTION
    if not summary.exists():
        return
    earlier, name = read_motion(summary), as_unicode(name)
    has_identities = earlier.video is not None and origin.identity is not None
    if earlier.video == origin.identity if has_identities else earlier.name == name:
        return
    # What is not a video at all is reported as such.
    origin.frames.describe()
    got = f"those of {earlier.name!r}" if earlier.name != name else f"those of another video called {name!r}"
    expected = f"another {argument}, or an empty folder"
    raise InputError("the results of another video", where=folder, got=got, expected=expected)
