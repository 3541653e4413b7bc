"""Start of the page: what it opens, where its results lie, and the address that the user is told."""

import os
import re
import sys
from importlib.util import find_spec
from pathlib import Path

from moseg.schemas.configs import Variant
from moseg.schemas.errors import InputError
from moseg.store import open_store
from moseg.workflows.api.run_settings import RunSettings
from moseg.workflows.api.segmentation import open_source
from moseg.workflows.api.video_inputs import STANDARD_INPUT, find_videos
from moseg.workflows.config.frame_range import FrameRange
from moseg.workflows.config.pipeline_choices import PipelineChoices
from moseg.workflows.exports import check_folder
from moseg.workflows.exports.motion_json import read_motion
from moseg.workflows.exports.outputs import MOTION
from moseg.workflows.runlog.status import LATEST
from moseg.workflows.view.opening import OpenOptions, run_opening, video_opening
from moseg.workflows.view.run_of_folder import find_run_of
from moseg.workflows.view.stored_runs import list_segmentations, read_run
from moseg.workflows.view.view_session import Opening, ViewSession

PACKAGES = ("starlette", "uvicorn")
"""The libraries that the server runs on; nothing else needs them."""
DEFAULT_OUT = "out"
_RUN = re.compile(r"\d{4,8}(T\d*(-[0-9a-f]*)?)?")


def start_view(
    what: str | None,
    out: str | None,
    port: int,
    has_browser: bool,
    choices: PipelineChoices,
    chosen: FrameRange,
    fps: float | None,
    variant: Variant,
    settings: RunSettings,
    given: tuple[str, ...] = (),
) -> None:
    """Open a page about a video, a folder of results or a run, and serve it until it is ended.

    Parameters
    ----------
    what : str or None
        A video, what `moseg segment` left in a folder, or a run's name; the page asks for a video where None.
    out : str or None
        Output folder; by default the folder that is opened, else ``out``.
    port : int
        0 for any free one.
    given : tuple of str
        Words of the command line, for the command that does without the page.

    Raises
    ------
    InputError
        A library is missing, the port is in use, there is no such video, folder or run, or nothing can be written.
    """
    require_view_packages()
    from moseg.workflows.view.application import ViewApplication
    from moseg.workflows.view.server import bind, serve

    folder = what if what is not None and (Path(what) / MOTION).is_file() else None
    target = Path(out or folder or DEFAULT_OUT)
    options = OpenOptions(target, choices, chosen, fps, variant, settings, given)
    opening = None if what is None else _choose_opening(what, folder, options)
    check_folder(target)
    address = bind(port)
    session = ViewSession(target)
    application = ViewApplication(
        session,
        lambda path: video_opening(str(path), path.stem, options),
        lambda run: run_opening(read_run(open_store(settings.store, create=False), run), target, settings),
        lambda: _list_runs(settings.store),
    )
    try:
        if opening is not None:
            session.open(*opening)
        print(f"moseg view: {address.url}", flush=True)
        if not settings.quiet:
            print("This address works on this machine alone, until Ctrl-C ends the page.", file=sys.stderr)
        serve(address, session, application, has_browser)
    finally:
        session.close()


def require_view_packages() -> None:
    """Raise InputError, with the command that installs them, if a library that the server needs is missing."""
    missing = [name for name in PACKAGES if find_spec(name) is None]
    if missing:
        expected = "pip install 'moseg[view]'"
        raise InputError(f"the page needs {' and '.join(missing)}", got="not installed", expected=expected)


def _choose_opening(what: str, folder: str | None, options: OpenOptions) -> tuple[str, Opening]:
    """Return the name and the opening of what a word names, which is looked at before the server starts."""
    is_run = not os.path.lexists(what) and (what == LATEST or _RUN.fullmatch(what) is not None)
    if folder is not None or is_run:
        _refuse_options(what, options)
    if folder is not None:
        summary = read_motion(Path(folder) / MOTION)
        store = open_store(options.run.store, create=False)
        run = find_run_of(store, Path(folder), summary)
        return summary.name, run_opening(run, options.out, options.run, summary)
    if is_run:
        run = read_run(open_store(options.run.store, create=False), what)
        return run.leaves.name, run_opening(run, options.out, options.run)
    if what == STANDARD_INPUT:
        raise InputError("a video that is read twice", got="standard input", expected="a file")
    videos = find_videos([what])
    if len(videos) != 1:
        raise InputError("several videos", got=f"{len(videos)} in {what}", expected="one")
    ((path, name, _),) = videos
    with open_source(path, options.choices, name, options.chosen, options.fps) as (source, _):
        # Bad input is reported at once, and not on the page.
        source.frames.describe()
    return name, video_opening(path, name, options)


def _refuse_options(what: str, options: OpenOptions) -> None:
    """Raise InputError if there are options that a finished result would not follow."""
    given = {
        "--start, --end or --every": options.chosen != FrameRange(),
        "--fps": options.fps is not None,
        "--variant": options.variant != Variant.FUSED,
        "an option of the pipeline": options.choices.read() != PipelineChoices().read(),
    }
    found = ", ".join(name for name, is_given in given.items() if is_given)
    if found:
        expected = "the video itself, or a result as it is (its settings can be changed on the page)"
        raise InputError("an option without effect on a finished result", where=what, got=found, expected=expected)


def _list_runs(store: str) -> list[dict]:
    try:
        return list_segmentations(open_store(store, create=False))
    except InputError:
        # Without a store there is no run yet.
        return []
