"""Segmenting a video by one call."""

import os
from dataclasses import replace
from functools import partial

import numpy as np

from moseg.schemas.configs import Variant
from moseg.schemas.errors import InputError
from moseg.schemas.scores import StoreUse
from moseg.store import ArtifactStore
from moseg.workflows.api.arguments import Kind, check_fps, check_kinds, check_name, named_as_arguments
from moseg.workflows.api.configuration import read_choices
from moseg.workflows.api.given_corrections import GivenCorrections, give_corrections
from moseg.workflows.api.motion_segmentation import MotionSegmentation
from moseg.workflows.api.moving_object import MovingObject
from moseg.workflows.api.process_settings import kept_process_settings
from moseg.workflows.api.run_settings import read_run_settings
from moseg.workflows.api.segmentation import open_source, run_segmentation
from moseg.workflows.api.video_source import VideoLike
from moseg.workflows.config.corrections_file import CorrectionsLike
from moseg.workflows.config.frame_range import read_frame_range
from moseg.workflows.config.pipeline_choices import ConfigLike
from moseg.workflows.exports import summarise_sequence
from moseg.workflows.exports.frame_origin import FrameOrigin
from moseg.workflows.pipelines.segment import StoredSegmentation


@named_as_arguments()
def segment_video(
    video: VideoLike,
    config: ConfigLike | None = None,
    *,
    motions: int | str | None = None,
    preset: str | None = None,
    light: bool = False,
    quality: str | None = None,
    geometry: str | None = None,
    sensitivity: float | None = None,
    variant: Variant | str = Variant.FUSED,
    corrections: CorrectionsLike | None = None,
    proposals: str | os.PathLike | None = None,
    depth: str | os.PathLike | None = None,
    flow: str | os.PathLike | None = None,
    tracks: str | os.PathLike | None = None,
    start: int | str | None = None,
    end: int | str | None = None,
    every: int | str | None = None,
    fps: float | None = None,
    report: str | os.PathLike | None = None,
    name: str | None = None,
    store: str | os.PathLike | None = None,
    workers: int = 0,
    scheduler: str | os.PathLike | None = None,
    tls_ca: str | os.PathLike | None = None,
    tls_cert: str | os.PathLike | None = None,
    tls_key: str | os.PathLike | None = None,
    device: str = "auto",
    threads: int = 1,
    batch: int | None = None,
    offline: bool = False,
    non_commercial: bool = False,
    accept_licence: str | None = None,
    progress: bool = True,
    keep_cues: bool = False,
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
    light : bool
        Take the preset's lighter networks, for a laptop; only ``modern`` has them.
    quality : 'fast', 'default' or 'best', optional
        What accuracy may cost.
    geometry : 'default' or 'paper', optional
        Fits, affinity and clustering.
    sensitivity : float, optional
        Divisor of the evidence that a moving object of dense tracks, or one that is compared with a rigid scene, needs;
        1 by default. A larger one finds more, and more that does not move. Read where ``proposal_source`` is ``auto``,
        as it is by default, ``tracks`` or ``motion-prompts``.
    variant : Variant or str
        Row of the paper's ablation: fused, oc-depth, oc, trajs or base.
    corrections : Corrections, mapping, list of edits or path, optional
        What you correct: a file as `moseg view` and `moseg segment` write it; a mapping of its ``settings`` and
        ``edits``; or edits alone, ``[{"drop": 2}, {"merge": [3, 4]}]``.
    proposals, depth, flow, tracks : path, optional
        Your own masks, inverse depth, flow or point tracks in place of a backend: folders as `moseg segment
        --proposals folder:PATH` and its like read them.
    start, end, every : int or str, optional
        First frame that is read; the one before which reading ends; and the distance between frames: a number of
        frames, ``'4.5s'``, or a timecode such as ``'0:04.5'``. By default all frames are read.
    fps : float, optional
        Frames per second, 0.1 to 1000; by default the video's own, 24 for frames without a rate. Results of every n-th
        frame have an n-th of it.
    report : path, optional
        Also write a page that shows the result and how it came about, as `moseg segment --report` does.
    name : str, optional
        What the result and files of it are called; by default after the file.
    store : path or URL, optional
        Artifact store: a folder, or the URL of one (``file://``, ``s3://``, ``gs://``, ``az://``); by default
        ``$MOSEG_STORE``, else ``moseg/store`` in the user's cache folder.
    workers : int
        Worker processes; 0 computes in this one. A script that asks for workers does so below ``if __name__ ==
        "__main__":``, because they import it.
    scheduler : str or path, optional
        Existing Dask cluster: ``tcp://host:8786``, ``tls://host:8786`` or a scheduler file.
    tls_ca, tls_cert, tls_key : path, optional
        PEM files for a scheduler at ``tls://``: the certificate of its authority, your own and its key.
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
    accept_licence : str, optional
        Names of licences with conditions that you accept, separated by commas: ``SAM-License`` for SAM 3.
    progress : bool
        Whether progress goes to standard error. Standard output is never written to.
    keep_cues : bool
        Whether flow, saliency and other dense maps stay in the store, for other settings and for reports of the run;
        by default they are deleted when the result is computed.

    Returns
    -------
    MotionSegmentation

    Raises
    ------
    InputError
        The video, an array, a parameter or a file cannot be used; the message is one line.
    StoreError, ClusterError
        The store or the worker processes failed.

    Examples
    --------
    >>> result = segment_video("holiday.mp4", motions=2)  # doctest: +SKIP
    >>> result.labels.shape  # doctest: +SKIP
    (240, 720, 1280)
    """
    variant = _read_variant(variant)
    check_kinds(Kind.PATH, optional=True, report=report)
    check_fps(fps)
    check_name(name)
    run = read_run_settings(
        store=store,
        workers=workers,
        scheduler=scheduler,
        tls_ca=tls_ca,
        tls_cert=tls_cert,
        tls_key=tls_key,
        device=device,
        threads=threads,
        batch=batch,
        offline=offline,
        non_commercial=non_commercial,
        accept_licence=accept_licence,
        progress=progress,
        keep_cues=keep_cues,
    )
    given = give_corrections(corrections)
    choices = read_choices(
        config,
        motions,
        preset,
        light,
        quality,
        geometry,
        sensitivity,
        proposals=proposals,
        depth=depth,
        flow=flow,
        tracks=tracks,
    )
    choices = replace(choices, corrected=given.corrections.settings)
    page = None if report is None else os.fsdecode(report)
    path = os.path.abspath(os.fsdecode(video)) if isinstance(video, str | os.PathLike) else None
    chosen = read_frame_range(start, end, every)
    with kept_process_settings(), open_source(video, choices, name, chosen, fps) as (source, config):
        origin = FrameOrigin(path, source.frames)
        given.check_video(origin)
        # Read now, and kept: the file may be gone when the result is saved.
        _ = origin.identity
        read = partial(_read, origin, given)
        uncorrected = choices.read_uncorrected()
        done = run_segmentation(source, config, variant, run, read, fps, page, "motions", chosen, given, uncorrected)
    return replace(done.value, store_use=done.use, notes=done.notes)


def _read(
    origin: FrameOrigin, given: GivenCorrections, store: ArtifactStore, stored: StoredSegmentation, fps: float
) -> MotionSegmentation:
    """Return the result; its use of the store is not known yet."""
    objects, look_at = _describe_objects(store, stored, fps)
    return MotionSegmentation(
        name=stored.name,
        shape=stored.shape,
        analysed_shape=stored.analysed_shape,
        fps=fps,
        num_frames=stored.num_frames,
        num_motions=stored.num_motions,
        objects=objects,
        look_at=look_at,
        store_use=StoreUse(computed=0, reused=0),
        _store=store,
        _stored=stored,
        _origin=origin,
        _given=given,
    )


def _read_variant(variant: Variant | str) -> Variant:
    try:
        return Variant(variant)
    except ValueError as error:
        expected = " or ".join(each.value for each in Variant)
        raise InputError("no such variant", where="variant", got=repr(variant), expected=expected) from error


def _describe_objects(
    store: ArtifactStore, stored: StoredSegmentation, fps: float
) -> tuple[tuple[MovingObject, ...], tuple[str, ...]]:
    """Return the moving objects, each with its support for being static, and what is worth a look."""
    labels = stored.labels(store)
    summary = summarise_sequence(
        stored.name,
        labels,
        fps,
        stored.num_motions,
        stored.motions,
        stored.tags,
        moves=stored.moves(store),
        growths=stored.growths(store),
        confidences=stored.confidences(store),
        given_names=stored.names,
        drawn=stored.drawn,
        advice=stored.advice,
        about_picture=stored.about_picture(store),
    )
    supports = stored.evidence.static_supports(store)
    row_of = {identity: row for row, identity in enumerate(stored.rows)}
    objects = tuple(
        MovingObject(
            **dict(each),
            # An object that a correction made was not compared with the background.
            static_support={
                view: float(support[row_of[each.identity]])
                for view, support in supports.items()
                if each.identity in row_of and not np.isnan(support[row_of[each.identity]])
            },
        )
        for each in summary.objects
    )
    return objects, summary.look_at
