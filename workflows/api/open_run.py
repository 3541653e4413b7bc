"""A video that stays open while it is corrected: the way from corrections to labels for a page, within milliseconds."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.corrections import Corrections
from moseg.schemas.errors import InputError
from moseg.store import ArtifactStore
from moseg.workflows.api.given_corrections import NO_CORRECTIONS, GivenCorrections, give_corrections
from moseg.workflows.api.run_settings import RunSettings
from moseg.workflows.api.segmentation import Outputs, open_source
from moseg.workflows.api.video_source import VideoLike
from moseg.workflows.config.corrections_file import CorrectionsLike
from moseg.workflows.config.frame_range import WHOLE, FrameRange
from moseg.workflows.config.frame_rate import choose_fps
from moseg.workflows.config.pipeline_choices import PipelineChoices
from moseg.workflows.datasets import SequenceSource
from moseg.workflows.exports.frame_origin import FrameOrigin
from moseg.workflows.exports.motion_json import SequenceSummary
from moseg.workflows.pipelines.correct import Change, OpenRun
from moseg.workflows.pipelines.purpose import Purpose
from moseg.workflows.pipelines.segment import StoredSegmentation


class OpenVideo:
    """One video with the corrections in force. Made by `open_run`; every method may be called from any thread.

    A page calls `apply` with all corrections after each change of them, and `labels` for the frames that it shows.

    Attributes
    ----------
    origin : FrameOrigin
        Where the frames come from; ``origin.identity`` is the digest of the video that corrections name.
    fps : float
        Frames per second.
    corrections : Corrections
        Those in force.
    """

    def __init__(self, run: OpenRun, source: SequenceSource, origin: FrameOrigin, choices: PipelineChoices, fps: float):
        self._run, self._source, self._choices = run, source, choices
        self._max_side = choices.read().max_side
        self._given = NO_CORRECTIONS
        self.origin, self.fps = origin, fps

    def apply(self, corrections: CorrectionsLike, where: str = "corrections") -> Change:
        """Compute the labels under corrections, in place of those in force, and return what changed.

        The first call computes what the store lacks of the whole video. After that, edits and settings of the
        affinity and the clustering take milliseconds. If it raises, what was in force stays.

        Parameters
        ----------
        corrections : Corrections, mapping, list of edits or path
            All of them, not only what is new.
        where : str
            What errors call them, where they come from no file.

        Raises
        ------
        InputError
            Corrections of another video, or that cannot be read or applied; the message is one line.
        """
        given = give_corrections(corrections, where)
        given.check_video(self.origin)
        change = self._run.apply(self.config_of(given), given.edits)
        self._given = given
        return change

    def config_of(self, given: GivenCorrections) -> PipelineConfig:
        """Return the configuration of a run with corrections; raises InputError where a setting cannot be applied."""
        config = replace(self._choices, corrected=given.corrections.settings).read()
        if config.max_side != self._max_side:
            expected = f"{self._max_side}, or another run"
            raise InputError(
                "frames of another size", where=f"{given.source}: max_side", got=config.max_side, expected=expected
            )
        return config

    @property
    def corrections(self) -> Corrections:
        """The corrections in force, with the digest of the video."""
        return self._given.of_video(self.origin)

    @property
    def name(self) -> str:
        """Name of the video."""
        return self._source.name

    @property
    def num_frames(self) -> int:
        """Frames of the video, after the first `apply`."""
        return self._run.num_frames

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width of the video's frames, px."""
        return self._source.frames.describe().size

    @property
    def analysed_shape(self) -> tuple[int, int]:
        """Height and width of `labels` and `image`, px."""
        return self._run.analysed_shape

    @property
    def run(self) -> OpenRun:
        """The run, with its graph and its store, for what lies behind the result (cues, proposals)."""
        return self._run

    @property
    def store(self) -> ArtifactStore:
        """The artifact store."""
        return self._run.store

    def labels(self, frame: int) -> np.ndarray:
        """Return labels uint16 (y, x) of one frame as analysed: 0 static, else an identity."""
        return self._run.labels(frame)

    def image(self, frame: int) -> np.ndarray:
        """Return one frame as analysed, uint8 (y, x, 3) RGB."""
        return self._run.image(frame)

    def judge(self) -> StoredSegmentation:
        """Return all that is known of the result in force, also when objects rest and how sure their masks are.

        It computes what `apply` leaves out, which takes longer.
        """
        return self._run.judge()

    def save(self, folder: str | os.PathLike, **outputs) -> tuple[SequenceSummary, tuple[Path, ...]]:
        """Write what `moseg segment` writes under these corrections, byte for byte, and return summary and paths.

        Parameters
        ----------
        folder : path
        outputs
            As for `Outputs`: ``style``, ``has_full_size``, ``exports``, ``dilation``, ``sets``, ``step``.

        Raises
        ------
        InputError
            The folder cannot be written, or holds what is not to be replaced.
        """
        style = outputs.pop("style", None)
        files = Outputs(
            os.fsdecode(folder), self.origin, style, self.name, corrections=self._given, argument="folder", **outputs
        )
        with files:
            summary = files.write(self.store, self.judge(), self.fps)
            return summary, (*files.paths, *files.export())


@contextmanager
def open_run(
    video: VideoLike,
    settings: RunSettings,
    choices: PipelineChoices | None = None,
    variant: Variant = Variant.FUSED,
    name: str | None = None,
    chosen: FrameRange = WHOLE,
    fps: float | None = None,
) -> Iterator[OpenVideo]:
    """Open a video for the block, to be corrected; nothing is computed before `OpenVideo.apply`.

    Parameters
    ----------
    video : path, array or iterable of arrays
    settings : RunSettings
        Where results lie and who computes. With ``keep_cues=False`` each change would compute everything again.
    choices : PipelineChoices, optional
        The pipeline without corrections.
    variant : Variant
    name : str, optional
        Of the video; by default after the file.
    chosen : FrameRange
        Frames that are read.
    fps : float, optional
        Frames per second, where they have no times of their own.

    Raises
    ------
    InputError
        The video, a choice or the store cannot be used.
    """
    choices = choices or PipelineChoices()
    with open_source(video, choices, name, chosen, fps) as (source, _), settings.open() as session:
        path = os.path.abspath(os.fsdecode(video)) if isinstance(video, str | os.PathLike) else None
        rate = chosen.thinned_rate(choose_fps(fps, source.frames.describe().fps))
        origin = FrameOrigin(path, source.frames)
        purpose = Purpose(
            "segment",
            source.notes,
            rate,
            video=origin.identity,
            uncorrected=choices.read(),
            video_frames=origin.recorded(),
        )
        yield OpenVideo(OpenRun(session, source, variant, purpose), source, origin, choices, rate)
