"""Segmenting a video by one call."""

import os

import numpy as np

from moseg.schemas.configs import Variant
from moseg.schemas.errors import InputError
from moseg.store import ArtifactStore
from moseg.workflows.api.arguments import (
    Kind,
    check_fps,
    check_kinds,
    check_least,
    check_name,
    named_as_arguments,
)
from moseg.workflows.api.configuration import CUES, ConfigLike, load_config, with_given_cues
from moseg.workflows.api.motion_segmentation import MotionSegmentation
from moseg.workflows.api.moving_object import MovingObject
from moseg.workflows.api.process_settings import kept_process_settings
from moseg.workflows.api.video_source import VideoLike, open_video
from moseg.workflows.config.notes import motions_note
from moseg.workflows.datasets.given_folders import with_given_folders
from moseg.workflows.engine.session import open_session
from moseg.workflows.exports import summarise_sequence
from moseg.workflows.exports.motion_json import frame_names
from moseg.workflows.pipelines.purpose import Purpose
from moseg.workflows.pipelines.segment import StoredSegmentation, segment
from moseg.workflows.reports.run_report import RunReport
from moseg.workflows.sources.frames import choose_fps


@named_as_arguments()
def segment_video(
    video: VideoLike,
    config: ConfigLike | None = None,
    *,
    motions: int | str | None = None,
    preset: str | None = None,
    quality: str | None = None,
    geometry: str | None = None,
    variant: Variant | str = Variant.FUSED,
    proposals: str | os.PathLike | None = None,
    depth: str | os.PathLike | None = None,
    flow: str | os.PathLike | None = None,
    tracks: str | os.PathLike | None = None,
    fps: float | None = None,
    report: str | os.PathLike | None = None,
    name: str | None = None,
    store: str | os.PathLike = ".moseg/store",
    workers: int = 0,
    device: str = "auto",
    threads: int = 1,
    batch: int | None = None,
    offline: bool = False,
    non_commercial: bool = False,
    progress: bool = True,
) -> MotionSegmentation:
    """Find what moves on its own in a video: the same results as `moseg segment`, from the same store.

    What is already in the store is not computed again; an interrupted call goes on from there when it is made again.

    Parameters
    ----------
    video : path, array or iterable of arrays
        A video file or a folder of frames; uint8 (frame, y, x, 3) RGB or (frame, y, x) grey; or frames one by one,
        which are read once, with one in memory at a time. Arrays lie in a temporary file during the call.
    config : PipelineConfig, mapping or path, optional
        A whole configuration; single parameters (``{"sections.length": 20}``) on top of the preset; or a YAML file of
        such, as `moseg config dump` writes it.
    motions : int or 'auto', optional
        Number of motions, the background's included; by default what `config` says, which is ``auto``.
    preset : 'weights-free', 'paper' or 'modern', optional
        Set of backends, weights-free by default.
    quality : 'fast', 'default' or 'best', optional
        What accuracy may cost.
    geometry : 'default' or 'paper', optional
        Fits, affinity and clustering.
    variant : Variant or str
        Row of the paper's ablation: fused, oc-depth, oc, trajs or base.
    proposals, depth, flow, tracks : path, optional
        Your own masks, inverse depth, flow or point tracks in place of a backend: folders as `moseg segment
        --proposals folder:PATH` and its like read them.
    fps : float, optional
        Frames per second of the results, 0.1 to 1000; by default the video's own, 24 for frames without a rate.
    report : path, optional
        Also write a page that shows the result and how it came about, as `moseg segment --report` does.
    name : str, optional
        What the result and files of it are called; by default after the file.
    store : path or URL
        Artifact store: a folder, or the URL of one (``file://``, ``s3://``, ``gs://``, ``az://``).
    workers : int
        Worker processes; 0 computes in this one. A script that asks for workers does so below ``if __name__ ==
        "__main__":``, because they import it.
    device : str
        Where networks run: auto, cpu, cuda, cuda:N or mps.
    threads : int
        CPU threads of each process.
    batch : int, optional
        Frames in one pass of a network.
    offline : bool
        Fetch no weights; what is missing is an error.
    non_commercial : bool
        Allow weights that are licensed for non-commercial use only.
    progress : bool
        Whether to tell on standard error how far the work is. Standard output is never written to.

    Returns
    -------
    MotionSegmentation

    Raises
    ------
    InputError
        The video, an array, a parameter or a file cannot be used; the message is one line.
    StoreError, ClusterError
        The store or the worker processes failed.
    """
    variant = _read_variant(variant)
    check_kinds(Kind.PATH, store=store)
    check_kinds(Kind.PATH, optional=True, proposals=proposals, depth=depth, flow=flow, tracks=tracks, report=report)
    check_kinds(Kind.TEXT, device=device)
    check_kinds(Kind.SWITCH, offline=offline, non_commercial=non_commercial, progress=progress)
    check_least(0, workers=workers)
    check_least(1, threads=threads, **({} if batch is None else {"batch": batch}))
    check_fps(fps)
    check_name(name)
    given = zip(CUES, (proposals, depth, flow, tracks), strict=True)
    folders = {cue: os.fsdecode(path) for cue, path in given if path is not None}
    config = load_config(config, motions=motions, preset=preset, quality=quality, geometry=geometry)
    config = with_given_cues(config, folders)
    session_options = {"workers": workers, "device": device, "threads": threads, "batch": batch}
    session_options |= {"offline": offline, "non_commercial": non_commercial, "quiet": not progress}
    with kept_process_settings(), open_video(video, name, config.max_side) as source:
        source = with_given_folders(source, folders, config.max_side)
        notes = motions_note(config, "motions")
        rate = choose_fps(fps, source.frames.describe().fps)
        page = None if report is None else RunReport(os.fsdecode(report), source.name, config, [variant], [source.name])
        with open_session(os.fsdecode(store), **session_options) as session:

            def read(stored: StoredSegmentation) -> tuple[StoredSegmentation, tuple[MovingObject, ...]]:
                return stored, _describe_objects(session.store, stored, rate)

            purpose, panels = Purpose("segment", notes, rate), None if page is None else page.panels
            stored, objects = segment(session, source, config, variant, read, purpose, panels)
            if page is not None:
                page.note_facts(session)
            result = MotionSegmentation(
                name=stored.name,
                shape=stored.shape,
                analysed_shape=stored.analysed_shape,
                fps=rate,
                num_frames=stored.num_frames,
                num_motions=stored.num_motions,
                objects=objects,
                store_use=session.use(),
                notes=notes,
                _store=session.store,
                _stored=stored,
                _frame_names=frame_names(source.frames),
                _video=os.path.abspath(os.fsdecode(video)) if isinstance(video, str | os.PathLike) else None,
            )
        if page is not None:
            page.write((), notes)
        return result


def _read_variant(variant: Variant | str) -> Variant:
    try:
        return Variant(variant)
    except ValueError as error:
        expected = " or ".join(each.value for each in Variant)
        raise InputError("no such variant", where="variant", got=repr(variant), expected=expected) from error


def _describe_objects(store: ArtifactStore, stored: StoredSegmentation, fps: float) -> tuple[MovingObject, ...]:
    """The moving objects, each with what the motion models say of it."""
    labels = stored.labels(store)
    summary = summarise_sequence(stored.name, labels, fps, stored.num_motions, stored.motions, stored.tags)
    supports = {view: store.read(ref, "static_support") for view, ref in stored.affinity_refs.items()}
    row_of = {identity: row for row, identity in enumerate(stored.rows)}
    return tuple(
        MovingObject(
            **each.model_dump(),
            static_support={
                view: float(support[row_of[each.identity]])
                for view, support in supports.items()
                if not np.isnan(support[row_of[each.identity]])
            },
        )
        for each in summary.objects
    )
