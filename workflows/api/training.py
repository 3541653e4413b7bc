"""Training of the motion network, from options to files."""

from collections.abc import Iterable
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from pydantic import BaseModel, ValidationError

from moseg.schemas.digests import digest_json
from moseg.schemas.errors import InputError
from moseg.schemas.parameters import NetworkTrainingParams, VideoTrainingParams
from moseg.schemas.spelling import closest
from moseg.workflows.config.pipeline_choices import PipelineChoices
from moseg.workflows.datasets import SequenceSource
from moseg.workflows.engine.session import Session, open_session
from moseg.workflows.pipelines.video_clips import cue_config, describe_clips, make_clips
from moseg.workflows.process.devices import set_device
from moseg.workflows.process.resources import check_bearable
from moseg.workflows.sources import MotionWeights, open_frames
from moseg.workflows.sources.video_folder import list_videos
from moseg.workflows.training.clip_files import ClipFolder
from moseg.workflows.training.requirements import require_packages
from moseg.workflows.training.result import Trained, check_result
from moseg.workflows.training.start import Start

if TYPE_CHECKING:
    from moseg.schemas.configs import PipelineConfig

Params = TypeVar("Params", bound=BaseModel)
MIN_FRAMES = 5
"""Of a video to train on; shorter ones are left out."""


def run_scene_training(
    start: str | None,
    out: str,
    folder: str,
    seed: int,
    workers: int,
    threads: int,
    device: str,
    quiet: bool,
    settings: Iterable[tuple[str, object]],
) -> Trained:
    """Train the network on rendered scenes, from random weights or from those of the file `start`; write it to `out`.

    See `train_on_scenes`.
    """
    params = read_params(NetworkTrainingParams, settings)
    path = prepare(out, workers, threads, device)
    from moseg.workflows.training.rendered_scenes import train_on_scenes

    begun = None if start is None else _read_start(start)
    return train_on_scenes(path, Path(folder), begun, params, seed, workers, threads, quiet)


def run_video_training(
    videos: str,
    start: str,
    store: str,
    out: str,
    folder: str,
    seed: int,
    workers: int,
    threads: int,
    device: str,
    quiet: bool,
    settings: Iterable[tuple[str, object]],
) -> Trained:
    """Go on from the network in the file `start`, or from the one that comes with this program, on a folder of videos.

    See `train_on_clips`.
    """
    params = read_params(VideoTrainingParams, settings)
    path = prepare(out, workers, threads, device)
    begun = _read_start(start)
    # Only now, because it imports torch.
    from moseg.workflows.training.videos import train_on_clips

    config = cue_config(PipelineChoices().read())
    sources = _open_videos(videos, config)
    with open_session(store, workers=workers if workers > 1 else 0, quiet=quiet) as session:
        clips = [clip for source in sources for clip in _clips_of(session, source, config, params, Path(folder))]
    made = {"clips": digest_json("clips", [each.parent.name for each in clips])}
    return train_on_clips(path, Path(folder), begun, clips, params, seed, workers, threads, quiet, made)


def _read_start(file: str) -> Start:
    """Return the network in a file, or without a name the one that comes with this program; raises InputError."""
    from moseg.tasks.motion_network.restore import from_onnx

    content = MotionWeights(file).read().tobytes()
    return Start(from_onnx(content), sha256(content).hexdigest())


def _open_videos(folder: str, config: "PipelineConfig") -> list[SequenceSource]:
    """Return the videos in a folder that are long enough; raises InputError without any."""
    sources = [SequenceSource(Path(path).stem, open_frames(path, config.max_side)) for path in list_videos(folder)]
    found = [source for source in sources if source.frames.num_frames() >= MIN_FRAMES]
    if not found:
        raise InputError("no video is long enough", where=folder, expected=f"{MIN_FRAMES} frames or more")
    return found


def _clips_of(
    session: Session, source: SequenceSource, config: "PipelineConfig", params: VideoTrainingParams, folder: Path
) -> tuple[Path, ...]:
    """Return the files of the clips of a video, made if they are not complete."""
    clips = ClipFolder(folder, describe_clips(source, config, params.clip))
    if not clips.is_complete():
        make_clips(session, source, config, params.clip, clips.write)
        clips.complete()
    return clips.paths()


def prepare(out: str, workers: int, threads: int, device: str) -> Path:
    """Check all that may be wrong before a training, and return the path of its result; raises InputError."""
    check_bearable(workers, "workers")
    check_bearable(threads, "threads")
    require_packages()
    set_device(device)
    return check_result(out)


def read_params(model: type[Params], settings: Iterable[tuple[str, object]]) -> Params:
    """Return the parameters of a training; settings without a value are left at their default; raises InputError."""
    values = {name: value for name, value in settings if value is not None}
    try:
        return model.model_validate(values)
    except ValidationError as error:
        first = error.errors()[0]
        name = str(first["loc"][0])
        if first["type"] == "extra_forbidden":
            close = closest(name, model.model_fields)
            expected = f"did you mean {close!r}?" if close else ", ".join(model.model_fields)
            raise InputError("unknown parameter of the training", got=repr(name), expected=expected) from error
        expected = first["msg"].removeprefix("Input should be ").partition(", unable to parse")[0]
        raise InputError("bad parameter", where=name, got=repr(first["input"]), expected=expected) from error
