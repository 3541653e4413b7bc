"""Valid files of text and of weights: configurations, lists, summaries, logs of runs, checkpoints."""

import io
import json
from datetime import UTC, datetime
from pathlib import Path

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.events import (
    DegenerateEvent,
    EventKind,
    Outcome,
    PlanEvent,
    RunClosed,
    RunOpened,
    SequenceSubject,
    SubjectEvent,
    TroubleEvent,
    WorkEvent,
    write_event,
)
from moseg.store import open_store
from moseg.store.owners import process_space
from moseg.workflows.config.config_files import write_config
from moseg.workflows.config.corrections_file import read_corrections, spell_corrections

RUN = "20261122T000000-aaaaaa"
_TIME = datetime(2026, 11, 22, tzinfo=UTC)


def config_files() -> tuple[bytes, ...]:
    """Return some parameters, written by hand and as they are dumped."""
    changed = PipelineConfig.model_validate(
        {
            "max_side": 640,
            "sections": {"length": 7},
            "flow": {"method": "raft"},
            "detections": {"tags": ["a dog", "car"]},
        }
    )
    by_hand = "# mine\nmax_side: 640\nsections: {length: 7, overlap: 2}\nproposals:\n  method: 'saliency'\n"
    return by_hand.encode(), write_config(changed, changed_only=True).encode()


def corrections_files() -> tuple[bytes, ...]:
    """Return corrections with every kind of edit, as they are written."""
    strokes = [{"radius": 9, "points": [[1, 2.5], [3, 4]]}]
    edits = [
        *({kind: 2} for kind in ("drop", "keep", "static", "moving")),
        {"merge": [3, 4]},
        {"split": {"object": 2, "frame": 31, "into": 7}},
        {"rename": {"object": 2, "name": "a <b>: bear"}},
        {"paint": {"object": 2, "frame": 12, "strokes": strokes}},
        {"erase": {"frame": 12, "strokes": strokes}},
        {"add": {"object": 8, "frame": 12, "points": [[5, 6]], "by": "sam2"}},
    ]
    corrections = read_corrections({"settings": {"clustering.motions": 3, "affinity.scale": 0.4}, "edits": edits})
    return (spell_corrections(corrections).encode(),)


def lists_of_weights() -> tuple[bytes, ...]:
    """Return a list of items that a user adds."""
    files = [
        {"name": "model.pth", "url": "https://example.org/a/model.pth", "size": 10, "sha256": "0" * 64},
        {"name": "config.json"},
    ]
    item = {"name": "mine", "architecture": "sam2", "licence": "MIT", "files": files, "config": {"width": 3}}
    return (json.dumps({"items": [item, {**item, "name": "other"}]}, indent=1).encode(),)


def pins() -> tuple[bytes, ...]:
    """Return the record of a first download."""
    pin = {"source": "https://example.org/a", "sha256": "0" * 64, "size": 10}
    return (json.dumps({"commits": {"a/b@main": "0" * 40}, "files": {"model.pth": pin}}).encode(),)


def checkpoints(suffix: str) -> tuple[bytes, ...]:
    """Return two tensors, as torch saves them now and saved them formerly, or as safetensors."""
    import torch

    tensors = {"a.weight": torch.arange(6.0).reshape(2, 3), "a.bias": torch.ones(2, dtype=torch.float16)}
    if suffix == ".safetensors":
        from safetensors.torch import save

        return (save(tensors),)
    contents = []
    for content, is_zip in (
        (tensors, True),
        ({"state_dict": tensors, "epoch": 3, "rate": 0.1}, True),
        (tensors, False),
    ):
        stream = io.BytesIO()
        torch.save(content, stream, _use_new_zipfile_serialization=is_zip)
        contents.append(stream.getvalue())
    return tuple(contents)


def lists_of_sequences() -> tuple[bytes, ...]:
    """Return lists with names, comments and blank lines."""
    return b"# a list\ndog\n\nblackswan # a bird\ncows\n", "\ufeffhund\r\nkühe\r\n".encode()


def summaries(num_frames: int, height: int, width: int) -> tuple[bytes, ...]:
    """Return ``motion.json`` of a video and of a folder."""
    entry = {"identity": 1, "motion": 1, "first_frame": 0, "last_frame": 1, "num_frames": 2, "mean_area_fraction": 0.1}
    common = {"name": "dog", "num_frames": num_frames, "width": width, "height": height, "fps": 24.0, "num_motions": 2}
    objects = [entry, {**entry, "identity": 2, "tag": "a dog"}, {**entry, "identity": 3}]
    frames = [f"{number}.jpg" for number in range(num_frames)]
    return tuple(
        json.dumps({**common, "objects": objects, "frames": each}, indent=2).encode() for each in (None, frames)
    )


def listings() -> tuple[bytes, ...]:
    """Return the names of the files that an export wrote."""
    return (b'[\n"00000.png",\n"00001.png",\n"k\xc3\xbche.png"\n]\n',)


def scheduler_files() -> tuple[bytes, ...]:
    """Return a scheduler file as `dask scheduler --scheduler-file` writes it."""
    return (json.dumps({"type": "Scheduler", "address": "tcp://127.0.0.1:8786", "workers": {}}, indent=2).encode(),)


def run_logs() -> tuple[bytes, ...]:
    """Return the logs of a run that went well and of one that failed."""
    process = {"time": _TIME, "host": "node7", "pid": 2**22 + 1}
    opened = RunOpened(
        **process,
        run_id=RUN,
        space=process_space(),
        command=("moseg", "segment", "a.mp4"),
        folder="/home/me",
        version="0.1.0",
        num_workers=2,
    )
    refs = [f"{stage}/{number:064x}" for stage in ("flow", "depth") for number in range(2)]
    leaves = {"name": "dog", "shape": [24, 32], "frames": [f"frame/{number:064x}" for number in range(4)]}
    subject = SubjectEvent(
        **process,
        command="segment",
        variants=("fused",),
        config=PipelineConfig().model_dump(mode="json"),
        sequences=(SequenceSubject(leaves=leaves, fps=24.0),),
    )
    work = [
        WorkEvent(**process, event=kind, ref=ref, seconds=0.5)
        for ref in refs
        for kind in (EventKind.STARTED, EventKind.COMPUTED, EventKind.COMMITTED)
    ]
    events = [
        opened,
        subject,
        *(PlanEvent(event=EventKind.PLANNED, time=_TIME, ref=ref) for ref in refs),
        PlanEvent(event=EventKind.HIT, time=_TIME, ref=f"frame/{0:064x}"),
        *work[:-1],
        DegenerateEvent(**process, ref=refs[0], num_invalid=1, num_fits=3, reasons={"too few points": 1}),
    ]
    failed = TroubleEvent(**process, event=EventKind.FAILED, ref=refs[-1], message="OSError: gone")
    ends = (
        (work[-1], RunClosed(**process, outcome=Outcome.FINISHED, pins=("a", "b"))),
        (failed, RunClosed(**process, outcome=Outcome.FAILED, message="OSError: gone")),
        (),
    )
    return tuple(b"".join(map(write_event, [*events, *end])) for end in ends)


def make_store(folder: Path) -> None:
    """Make an empty store with a place for the run's log."""
    open_store(str(folder), create=True)
    (folder / "logs" / RUN).mkdir(parents=True)
