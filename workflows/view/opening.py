"""Ways to open what the page shows: a video, which is segmented first, or a finished run, without computing it anew."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

from moseg.schemas.configs import Variant
from moseg.schemas.corrections import Corrections
from moseg.schemas.digests import digest_json
from moseg.store import open_store
from moseg.workflows.api.given_corrections import CORRECTIONS, give_corrections
from moseg.workflows.api.open_run import OpenVideo, open_run
from moseg.workflows.api.run_settings import RunSettings
from moseg.workflows.config.frame_range import FrameRange
from moseg.workflows.config.frame_rate import choose_fps
from moseg.workflows.config.pipeline_choices import PipelineChoices
from moseg.workflows.datasets import SequenceSource
from moseg.workflows.exports.motion_json import SequenceSummary, read_motion
from moseg.workflows.exports.outputs import MOTION, check_outputs, check_same_video
from moseg.workflows.pipelines.correct import OpenRun
from moseg.workflows.pipelines.purpose import Purpose
from moseg.workflows.view.growing_methods import list_growing_methods
from moseg.workflows.view.opened import ExportChoices, Opened, Written
from moseg.workflows.view.shown_result import ShownResult
from moseg.workflows.view.stored_frames import StoredFrames, find_origin
from moseg.workflows.view.stored_runs import StoredRun
from moseg.workflows.view.uploads import FOLDER
from moseg.workflows.view.view_session import Opening
from moseg.workflows.view.writing import write_result


@dataclass(frozen=True)
class OpenOptions:
    """Settings with which videos are opened.

    Attributes
    ----------
    out : Path
        Output folder.
    choices : PipelineChoices
    chosen : FrameRange
    fps : float or None
    variant : Variant
    run : RunSettings
    options : tuple of str
        Words of the command line that stand for these choices, for the command that does without the page.
    """

    out: Path
    choices: PipelineChoices
    chosen: FrameRange
    fps: float | None
    variant: Variant
    run: RunSettings
    options: tuple[str, ...] = ()

    @property
    def thinned_fps(self) -> float | None:
        """Frames per second of the chosen frames, as far as the rate is given."""
        return None if self.fps is None else self.chosen.thinned_rate(self.fps)


def video_opening(path: str, name: str | None, options: OpenOptions) -> Opening:
    """Return the opening of a video: it is segmented, as far as that is not stored, and its results are written."""

    def open_video(stack: ExitStack) -> Opened:
        settings = replace(options.run, keep_cues=True)
        arguments = settings, options.choices, options.variant, name, options.chosen, options.fps
        video = stack.enter_context(open_run(path, *arguments))
        check_outputs(str(options.out), path)
        check_same_video(str(options.out), video.origin, video.name)
        opened = _open(video, options, ("segment", path, *options.options))
        file = options.out / MOTION
        found = read_motion(file) if file.exists() else opened.write(ExportChoices())
        return replace(opened, look_at=found.look_at)

    return open_video


def run_opening(run: StoredRun, out: Path, settings: RunSettings, summary: SequenceSummary | None = None) -> Opening:
    """Return the opening of a finished run.

    Parameters
    ----------
    summary : SequenceSummary, optional
        What the output folder has of it, if that is what is opened.
    """

    def open_stored(stack: ExitStack) -> Opened:
        # Opened first, so that nothing is created where there is no store.
        open_store(settings.store, create=False)
        session = stack.enter_context(replace(settings, keep_cues=True).open())
        fps = choose_fps(None if summary is None else summary.fps, run.fps)
        shape = run.leaves.frame_size or run.leaves.shape
        if summary is not None:
            shape = summary.height, summary.width
        frames = StoredFrames.of_size(session.store, run.leaves.frames, shape, fps)
        source = SequenceSource(run.leaves.name, frames)
        origin = find_origin(frames, run, out, summary)
        leaves = run.leaves._replace(edits=())
        words = _as_segment(run.words, run.leaves.name, out)
        base = run.uncorrected
        purpose = Purpose(
            "segment", words=words, video=origin.identity, uncorrected=base, video_frames=origin.recorded()
        )
        choices = PipelineChoices.of_run(base)
        video = OpenVideo(OpenRun(session, source, run.variant, purpose, leaves, base), source, origin, choices, fps)
        options = OpenOptions(out, choices, FrameRange(), fps, run.variant, settings)
        opened = _open(video, options, words)
        return opened if summary is None else replace(opened, look_at=summary.look_at)

    return open_stored


def _open(video: OpenVideo, options: OpenOptions, words: Sequence[str]) -> Opened:
    """Return an open video without any correction, which is computed as far as it is not stored."""
    file = str(options.out / CORRECTIONS)

    def correct(corrections: Corrections) -> ShownResult:
        video.apply(corrections, file)
        run, config = video.run, video.config_of(give_corrections(corrections))
        edits = [edit.model_dump(mode="json") for edit in corrections.edits]
        return ShownResult(
            store=video.store,
            graph=run.graph,
            config=config,
            variant=options.variant,
            live=run.live,
            key=digest_json("shown", [run.graph.leaves.frames, config.model_dump(mode="json"), edits])[:16],
            name=video.name,
            shape=shape,
            fps=video.fps,
        )

    def write(choices: ExportChoices) -> Written:
        return write_result(video, options.out, choices, options.thinned_fps)

    # Both are asked for while the video is there: it may be removed later.
    shape, identity, part = video.shape, video.origin.identity, video.origin.part
    first = correct(Corrections())
    return Opened(
        first=first,
        correct=correct,
        write=write,
        prepare=video.run.prepare_steps(),
        repair=video.run.repair,
        video=identity,
        part=part,
        has_video=video.origin.path is not None,
        words=tuple(_without_outputs(words)),
        growing=tuple(list_growing_methods(first.config, options.run.non_commercial)),
    )


def _as_segment(words: tuple[str, ...], name: str, out: Path) -> tuple[str, ...]:
    """Return the words of the run's own command as those of `moseg segment`; a page or Python may have made the run."""
    if words[:1] == ("segment",):
        return tuple(words)
    if words[:1] != ("view",):
        return "segment", "VIDEO"
    kept, given = [], iter(words[1:])
    for word in given:
        if word == "--port":
            next(given, None)
        elif word != "--no-browser" and not word.startswith("--port="):
            kept.append(word)
    # A video that was dropped into the page is no word of its command.
    sent = [str(path) for path in sorted((out / FOLDER).glob("*")) if path.stem == name]
    return ("segment", *sent[:1], *kept)


_EDITS = ("--split", "--rename", "--merge", "--static", "--moving", "--keep", "--drop")
_LEFT_OUT = ("--out", "-o", "--corrections", *_EDITS)
"""Options of an output folder and of corrections; each has a value."""


def _without_outputs(words: Iterable[str]) -> Iterator[str]:
    """Yield the words of a command without those that name its output and its corrections."""
    given = iter(words)
    for word in given:
        if word in _LEFT_OUT:
            next(given, None)
        elif not word.startswith(tuple(f"{each}=" for each in _LEFT_OUT)):
            yield word
