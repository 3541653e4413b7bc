"""Every way by which a file from outside enters the program, and the valid files that are damaged for it."""

from collections.abc import Callable, Iterator
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import seed_documents as documents
import seed_pictures as pictures
from format_mutations import (
    mutate_boxes,
    mutate_mat,
    mutate_npy,
    mutate_png,
    mutate_safetensors,
    mutate_text,
    mutate_zip,
)
from trials import Reader

from moseg.schemas.errors import InputError, StoreError
from moseg.schemas.weights import PINS, WeightsItem
from moseg.store import open_store
from moseg.workflows.api.given_corrections import CORRECTIONS
from moseg.workflows.cli.status_tables import status_view
from moseg.workflows.cli.tables import console
from moseg.workflows.cluster.connection import read_scheduler_file
from moseg.workflows.config.config_files import read_config_file
from moseg.workflows.config.corrections_file import read_corrections
from moseg.workflows.datasets.selection import read_list
from moseg.workflows.exports.owned_folder import LISTING, OwnedFolder
from moseg.workflows.exports.ownership import is_own_annotations, is_own_archive, is_own_mask, is_own_overlay
from moseg.workflows.exports.saved_segmentation import open_segmentation
from moseg.workflows.predictions import FrameList, open_predictions
from moseg.workflows.reports.from_log import report_run
from moseg.workflows.reports.page import render_page
from moseg.workflows.runlog.status import read_status
from moseg.workflows.sources import LabelledPointFile, MaskFiles, TrackFile, VideoFile, open_frames
from moseg.workflows.sources.depth_files import decode_depth
from moseg.workflows.sources.flow_files import decode_flow
from moseg.workflows.sources.mask_files import find_mask_kind
from moseg.workflows.sources.mat_tracks import decode_mat_tracks
from moseg.workflows.weights.own_items import OWN_ITEMS, read_own_items
from moseg.workflows.weights.pins import read_pins
from moseg.workflows.weights.reading import read_checkpoint

SHAPE, NUM_FRAMES = pictures.SHAPE, pictures.NUM_FRAMES
LARGEST_SIDE = 64
"""Size to which frames are reduced, px: steps after decoding are not tested here."""
_LOG = f"store/logs/{documents.RUN}/space-1.jsonl"


def list_readers(scratch: Path) -> Iterator[Reader]:
    """Return each reader, with its own folder below `scratch`; those that need torch only if it is installed."""
    yield from _readers_of_sources(scratch)
    yield from _readers_of_predictions(scratch)
    yield from _readers_of_documents(scratch)
    if find_spec("torch") is not None and find_spec("safetensors") is not None:
        yield from _readers_of_weights()


def _readers_of_sources(scratch: Path) -> Iterator[Reader]:
    yield Reader("video mp4", "video.mp4", pictures.video_files(scratch, ".mp4", ".mov"), _read_video, mutate_boxes)
    yield Reader("video mkv", "video.mkv", pictures.video_files(scratch, ".mkv", ".webm"), _read_video)
    others = pictures.video_files(scratch, ".avi", ".ts", ".flv", ".h264", ".gif")
    yield Reader("video other", "video.avi", others, _read_video)
    yield Reader("frame png", "frame.png", pictures.frame_pngs(), _read_frame, mutate_png)
    yield Reader("frame jpeg", "frame.jpg", pictures.frame_jpegs(), _read_frame)
    yield Reader("frame other", "frame.tif", pictures.other_frames(), _read_frame)
    yield Reader("mask png", "mask.png", pictures.label_pngs(), _read_mask, mutate_png)
    yield Reader("flow flo", "flow.flo", pictures.flo_files(), _read_cue(decode_flow))
    yield Reader("flow npy", "flow.npy", pictures.npy_files(pictures.FLOW), _read_cue(decode_flow), mutate_npy)
    yield Reader("flow png", "flow.png", pictures.flow_pngs(), _read_cue(decode_flow), mutate_png)
    yield Reader("depth npy", "depth.npy", pictures.npy_files(pictures.DEPTH), _read_cue(decode_depth), mutate_npy)
    yield Reader("depth png", "depth.png", pictures.depth_pngs(), _read_cue(decode_depth), mutate_png)
    tracks = pictures.npz_files(points=pictures.POINTS, visible=pictures.SEEN)
    yield Reader("tracks npz", "tracks.npz", tracks, _read_tracks, mutate_zip)
    yield Reader("tracks mat", "clip_Tracks.mat", pictures.mat_files(), _read_trajectories, mutate_mat)


def _readers_of_predictions(scratch: Path) -> Iterator[Reader]:
    def reader(form: str, file: str, seeds: tuple[bytes, ...], mutate=None) -> Reader:
        (scratch / form / file).parent.mkdir(parents=True, exist_ok=True)
        name = f"prediction {form} {Path(file).suffix[1:]}"
        return Reader(name, f"{form}/{file}", seeds, partial(_read_prediction, form), mutate)

    labels = pictures.LABELS
    yield reader("png", "dog/0.png", pictures.label_pngs(), mutate_png)
    yield reader("rigidmask", "dog/pm-0.pfm", pictures.pfm_files())
    layers = np.stack([labels[0] / 9.0, labels[1] / 8.0]).astype(np.float32)
    yield reader("em", "dog/0_proba.npy", pictures.npy_files(layers), mutate_npy)
    yield reader("em", "cat/0_binary.png", pictures.label_pngs(), mutate_png)
    yield reader("volume", "dog.npy", pictures.npy_files(labels), mutate_npy)
    yield reader("volume", "cat.npz", pictures.npz_files(labels=labels), mutate_zip)


def _readers_of_documents(scratch: Path) -> Iterator[Reader]:
    yield Reader("config yaml", "config.yaml", documents.config_files(), read_config_file, mutate_text)
    yield Reader("corrections yaml", CORRECTIONS, documents.corrections_files(), read_corrections, mutate_text)
    yield Reader("weights.json", OWN_ITEMS, documents.lists_of_weights(), _in_folder(read_own_items), mutate_text)
    yield Reader("pins.json", PINS, documents.pins(), _in_folder(read_pins), mutate_text)
    yield Reader(
        "sequence list", "list.txt", documents.lists_of_sequences(), lambda path: read_list(str(path)), mutate_text
    )
    yield Reader("scheduler file", "scheduler.json", documents.scheduler_files(), read_scheduler_file, mutate_text)
    yield Reader("export listing", LISTING, documents.listings(), _read_listing, mutate_text)
    (scratch / "out/masks").mkdir(parents=True)
    for number in range(NUM_FRAMES):
        (scratch / f"out/masks/{number:05d}.png").write_bytes(pictures.label_pngs()[0])
    (scratch / "out2/masks").mkdir(parents=True)
    summaries = documents.summaries(NUM_FRAMES, *SHAPE)
    (scratch / "out2/motion.json").write_bytes(documents.summaries(1, *SHAPE)[0])
    yield Reader("motion.json", "out/motion.json", summaries, _in_folder(_read_segmentation), mutate_text)
    read_masks = _in_folder(lambda folder: _read_segmentation(folder.parent))
    yield Reader("exported masks", "out2/masks/00000.png", pictures.label_pngs()[:4], read_masks, mutate_png)
    owned = [*pictures.video_files(scratch, ".mp4"), *pictures.label_pngs()[:3]]
    owned += [*pictures.npz_files(labels=pictures.LABELS), *documents.listings()]
    yield Reader("own files", "file", tuple(owned), _ask_for_owner)
    documents.make_store(scratch / "store")
    refusals = (InputError, StoreError)
    yield Reader("log, status", _LOG, documents.run_logs(), partial(_read_log, scratch), mutate_text, refusals)
    yield Reader("log, report", _LOG, documents.run_logs(), partial(_report, scratch), mutate_text, refusals)


def _readers_of_weights() -> Iterator[Reader]:
    for name, mutate in (("model.pth", _mutate_torch), ("model.safetensors", mutate_safetensors)):
        item = WeightsItem.model_validate({"name": "net", "architecture": "raft", "files": [{"name": name}]})
        seeds = documents.checkpoints(Path(name).suffix)
        yield Reader(
            f"weights {Path(name).suffix[1:]}", name, seeds, _in_folder(partial(read_checkpoint, item)), mutate
        )


def _mutate_torch(content: bytes, rng) -> bytes:
    """Damage members of an archive; files of torch's older format are not archives."""
    return mutate_zip(content, rng) if content[:2] == b"PK" else content


def _read_video(path: Path) -> None:
    video = VideoFile(str(path), LARGEST_SIDE)
    for _ in video.read():
        pass
    video.describe()


def _read_frame(path: Path) -> None:
    for _ in open_frames(str(path), LARGEST_SIDE).read():
        pass


def _read_mask(path: Path) -> None:
    kind = find_mask_kind((str(path),))
    for _ in MaskFiles(((0, str(path)),), kind).read():
        pass


def _read_cue(decode: Callable[[bytes, str], np.ndarray]) -> Callable[[Path], object]:
    return lambda path: decode(path.read_bytes(), str(path))


def _read_tracks(path: Path) -> None:
    TrackFile(str(path), NUM_FRAMES, SHAPE, LARGEST_SIDE).read()


def _read_trajectories(path: Path) -> None:
    decode_mat_tracks(path.read_bytes(), str(path))
    LabelledPointFile(str(path), NUM_FRAMES, SHAPE).read()


def _read_prediction(form: str, path: Path) -> None:
    folder = next(parent for parent in path.parents if parent.name == form)
    name = path.relative_to(folder).parts[0].partition(".")[0]
    num_frames = NUM_FRAMES if form == "volume" else 1
    sequence = open_predictions(folder, form).sequence(name, FrameList(num_frames), SHAPE)
    for index in range(num_frames):
        sequence.frame(index)


def _in_folder(read: Callable[[Path], object]) -> Callable[[Path], object]:
    """Return a reader of the folder that contains the file."""
    return lambda path: read(path.parent)


def _read_listing(path: Path) -> None:
    OwnedFolder(path.parent, ["00000.png"]).check()


def _read_segmentation(folder: Path) -> None:
    for _ in open_segmentation(folder).labels():
        pass


def _ask_for_owner(path: Path) -> None:
    for is_own in (is_own_annotations, is_own_archive, is_own_mask, is_own_overlay):
        is_own(path)


def _read_log(scratch: Path, path: Path) -> None:
    status = read_status(open_store(str(scratch / "store"), create=False), documents.RUN)
    out = console()
    with out.capture():
        out.print(status_view(status))
    status.model_dump_json(indent=2)


def _report(scratch: Path, path: Path) -> None:
    render_page(report_run(open_store(str(scratch / "store"), create=False), documents.RUN))
