"""Segmentations as the command line and Python run them: from choices to what was found, and to files."""

import os
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Generic, NamedTuple, TypeVar

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.errors import InputError
from moseg.schemas.scores import StoreUse
from moseg.store import ArtifactStore
from moseg.workflows.api.given_corrections import CORRECTIONS, NO_CORRECTIONS, GivenCorrections, check_kept
from moseg.workflows.api.run_settings import RunSettings
from moseg.workflows.api.video_source import VideoLike, open_video
from moseg.workflows.config.corrections_file import spell_corrections
from moseg.workflows.config.frame_range import WHOLE, FrameRange, Position
from moseg.workflows.config.frame_rate import choose_fps
from moseg.workflows.config.notes import motions_note
from moseg.workflows.config.pipeline_choices import PipelineChoices, refuse_ground_truth
from moseg.workflows.datasets import SequenceSource
from moseg.workflows.datasets.given_folders import with_given_folders
from moseg.workflows.exports.formats import FORMATS, check_exports, choose_formats, earlier_exports, export
from moseg.workflows.exports.formats.reconstruction_sets import SETS, choose_kept, choose_sets
from moseg.workflows.exports.frame_origin import FrameOrigin
from moseg.workflows.exports.motion_json import SequenceSummary
from moseg.workflows.exports.outputs import (
    MASKS,
    MOTION,
    OVERLAY,
    check_outputs,
    check_page,
    check_same_video,
    mask_name,
)
from moseg.workflows.exports.overlay_style import OverlayStyle
from moseg.workflows.exports.saved_segmentation import open_segmentation, required_origin
from moseg.workflows.exports.write_text import write_text
from moseg.workflows.pipelines.purpose import Purpose
from moseg.workflows.pipelines.segment import StoredSegmentation, segment
from moseg.workflows.pipelines.write_segmentation import write_segmentation
from moseg.workflows.plugins.loading import load_plugins
from moseg.workflows.process.atomic_write import file_state
from moseg.workflows.process.folder_lock import lock_folder
from moseg.workflows.reports.run_report import RunReport
from moseg.workflows.runlog.events import as_unicode

Value = TypeVar("Value")


@contextmanager
def open_source(
    video: VideoLike,
    choices: PipelineChoices,
    name: str | None = None,
    chosen: FrameRange = WHOLE,
    fps: float | None = None,
) -> Iterator[tuple[SequenceSource, PipelineConfig]]:
    """Open the user's own video for the block, with the configuration for it.

    Parameters
    ----------
    video : path, array or iterable of arrays
    choices : PipelineChoices
    name : str, optional
        Of the video; by default after the file.
    chosen : FrameRange
        Frames that are read.
    fps : float, optional
        Frames per second of the whole, where they have no times of their own.

    Raises
    ------
    InputError
        A choice is wrong or needs ground truth, or the video or a folder of cues cannot be read.
    """
    load_plugins()
    config = choices.read()
    refuse_ground_truth(config)
    with open_video(video, name, config.max_side, chosen, fps) as source:
        yield with_given_folders(source, choices.folders, config.max_side), config


class Segmented(NamedTuple, Generic[Value]):
    """The outcome of a run.

    Attributes
    ----------
    value : object
        What `use` made of the result.
    use : StoreUse
    seconds : float
    notes : tuple of str
        What must be known to read the result rightly.
    page : str or None
        The line that names the page, where one was asked for.
    """

    value: Value
    use: StoreUse
    seconds: float
    notes: tuple[str, ...]
    page: str | None


def run_segmentation(
    source: SequenceSource,
    config: PipelineConfig,
    variant: Variant,
    run: RunSettings,
    use: Callable[[ArtifactStore, StoredSegmentation, float], Value],
    fps: float | None = None,
    page: str | None = None,
    option: str = "--motions",
    chosen: FrameRange = WHOLE,
    corrections: GivenCorrections = NO_CORRECTIONS,
    uncorrected: PipelineConfig | None = None,
) -> Segmented[Value]:
    """Segment the user's own video.

    Parameters
    ----------
    use : function of the store, the result and its frames per second
        It is called again after it met a damaged artifact, once that is made again.
    fps : float, optional
        Frames per second of the results; the video's own, or 24, where None.
    page : str, optional
        File to write a page about the run to.
    option : str
        What the number of motions is given by, for notes.
    chosen : FrameRange
        Frames that `source` has of the whole, so that thinned ones play as fast.
    corrections : GivenCorrections
        Whose edits apply; `config` has their settings.
    uncorrected : PipelineConfig, optional
        The configuration without these settings, if there are any.

    Raises
    ------
    InputError
        The video cannot be read, or the page cannot be written.
    """
    origin = FrameOrigin(None, source.frames)
    notes = (*source.notes, *motions_note(config, option), *corrections.notes(origin))
    rate = chosen.thinned_rate(choose_fps(fps, source.frames.describe().fps))
    shown = None if page is None else RunReport(page, source.name, config, [variant], [source.name])
    purpose = Purpose(
        "segment", notes, rate, video=origin.identity, uncorrected=uncorrected, video_frames=origin.recorded()
    )
    panels = None if shown is None else shown.panels
    with run.open() as session:

        def read(stored: StoredSegmentation) -> Value:
            return use(session.store, stored, rate)

        value = segment(session, source, config, variant, read, purpose, panels, corrections.edits)
        if shown is not None:
            shown.note_facts(session)
    line = None if shown is None else shown.write((), notes)
    return Segmented(value, session.use(), session.seconds, notes, line)


class Outputs:
    """The files of a segmentation in a folder, checked before the work.

    A context: from the first file that it writes to the end of the block no other run writes in the folder, so that
    masks, summary and exports are of one run.

    Parameters
    ----------
    folder : str
        Created where it is absent.
    origin : FrameOrigin
        Where the frames come from.
    style : OverlayStyle or None
        Of the overlay; where None there is none.
    name : str
        Of the video.
    has_full_size : bool
        Whether the overlay has the video's own size, for which the video is decoded again.
    exports : iterable of str
        Formats to write beside the masks.
    dilation : int, optional
        How far the formats that ignore what moves widen its masks, px.
    argument : str
        What the folder was given by.
    num_frames : int, optional
        How many there are, if that is known without decoding.
    sets : iterable of str
        Programs for which frames and masks are written as one set.
    step : Position, optional
        Which of the frames a set has: each n-th, or one in so many seconds; all where None.
    fps : float, optional
        Frames per second of images, for a step in seconds.
    corrections : GivenCorrections
        Those in force, which are written beside the result.
    page : str, optional
        File of a page about the run.

    Raises
    ------
    InputError
        The folder cannot be written; the page may be one of the results; a file would be replaced that is not ours, or
        the video itself; it has the results or the corrections of another video, or corrections that would be lost;
        there is no such format, or it cannot hold these frames.
    """

    def __init__(
        self,
        folder: str,
        origin: FrameOrigin,
        style: OverlayStyle | None,
        name: str,
        has_full_size: bool = False,
        exports: Iterable[str] = (),
        dilation: int | None = None,
        argument: str = "--out",
        num_frames: int | None = None,
        sets: Iterable[str] = (),
        step: Position | None = None,
        fps: float | None = None,
        corrections: GivenCorrections = NO_CORRECTIONS,
        page: str | None = None,
    ):
        if has_full_size and origin.path is None:
            got, expected = "frames that were given as arrays", "the size analysed"
            raise InputError("no overlay of the video's own size", where="--overlay-size", got=got, expected=expected)
        self._folder, self._origin, self._style, self._dilation = Path(folder), origin, style, dilation
        self._has_full_size = has_full_size
        self._sets = choose_sets(sets)
        dilation_of_formats = None if self._sets and not exports else dilation
        self._formats = choose_formats(exports, dilation_of_formats, origin.names)
        for entry in (*self._formats, *self._sets):
            if entry.needs_frames:
                required_origin(origin, entry.name)
        self._name, self._argument, self._given_folder = name, argument, folder
        self._was_there = os.path.exists(self._folder)
        self._held, self._is_held = ExitStack(), False
        self._given, self._corrections = corrections, corrections.of_video(origin)
        self._earlier = self._check()
        corrections.check_video(origin)
        if page is not None:
            check_page(page, self._folder)
        if self._formats or self._sets:
            names = origin.names or tuple(map(mask_name, range(num_frames or origin.frames.num_frames())))
            check_exports(self._formats, self._folder, as_unicode(name), names)
            self._kept = choose_kept(origin, len(names), step, fps)
            thinned = names if self._kept is None else tuple(names[index] for index in self._kept)
            check_exports(self._sets, self._folder, as_unicode(name), thinned)

    def __enter__(self) -> "Outputs":
        return self

    def __exit__(self, kind, error, trace) -> None:
        self._held.close()
        self._is_held = False
        if kind is not None and not self._was_there:
            # A run that was refused leaves no empty folder.
            with suppress(OSError):
                self._folder.rmdir()

    def _check(self) -> tuple[int, int] | None:
        """Check that the results may be written, and return the state of the summary that is there."""
        check_outputs(self._given_folder, self._origin.path, self._style is not None, self._argument)
        check_same_video(self._given_folder, self._origin, self._name, self._argument)
        if self._corrections:
            check_kept(self._folder / CORRECTIONS, self._given, self._argument)
        return file_state(self._folder / MOTION)

    def _hold(self, quiet: bool) -> None:
        """Wait for other runs that write in the folder, and check again if there were any."""

        def report() -> None:
            if not quiet:
                print(f"moseg: waiting for another run that writes in {self._folder}", file=sys.stderr)

        if self._is_held:
            return
        self._held.enter_context(lock_folder(self._folder, report))
        self._is_held = True
        if file_state(self._folder / MOTION) != self._earlier:
            self._check()

    def write(
        self, store: ArtifactStore, stored: StoredSegmentation, fps: float, quiet: bool = True
    ) -> SequenceSummary:
        """Write masks, overlay and summary, and return what the summary holds; see `write_segmentation`."""
        self._hold(quiet)
        if self._corrections:
            write_text(self._folder / CORRECTIONS, spell_corrections(self._corrections))
        return write_segmentation(
            self._folder, store, stored, fps, self._style, self._origin, self._has_full_size, quiet
        )

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes about files that stay in the folder."""
        notes = []
        left = self._folder / CORRECTIONS
        if not self._corrections and left.exists() and not self._given.is_from(left):
            notes.append(f"{left} is not in force: --corrections {left} applies it")
        others = [entry for entry in FORMATS.values() if entry not in self._formats]
        sets = [entry for entry in SETS.values() if entry not in self._sets]
        earlier = earlier_exports((*others, *sets), self._folder, as_unicode(self._name))
        if earlier:
            paths, is_one = ", ".join(map(str, earlier)), len(earlier) == 1
            notes.append(
                f"{paths} {'is' if is_one else 'are'} of an earlier run; --export and --for write exports anew"
            )
        return tuple(notes)

    @property
    def paths(self) -> tuple[Path, ...]:
        """Paths that `write` writes."""
        names = (MASKS, MOTION) if self._style is None else (MASKS, OVERLAY, MOTION)
        return tuple(self._folder / name for name in (*names, *([CORRECTIONS] if self._corrections else ())))

    def export(self) -> tuple[Path, ...]:
        """Write the other formats, after `write`, and return their paths."""
        if not self._formats and not self._sets:
            return ()
        saved = open_segmentation(self._folder, origin=self._origin)
        written = export(saved, self._formats, self._folder, self._dilation)
        thinned = saved if self._kept is None else saved.thin(self._kept)
        return (*written, *export(thinned, self._sets, self._folder, self._dilation))
