"""Evaluating variants of the pipeline on a data set by one call."""

import os
from collections.abc import Iterable
from typing import Literal

from moseg.schemas.configs import TrajectoryVariant, Variant
from moseg.schemas.scores import EvaluationReport, StillReport
from moseg.schemas.trajectory_scores import TrajectoryReport
from moseg.workflows.api.arguments import Kind, check_kinds, check_min, named_as_arguments, read_names
from moseg.workflows.api.configuration import read_choices
from moseg.workflows.api.evaluation import DataChoice, read_data, run_evaluation
from moseg.workflows.api.process_settings import kept_process_settings
from moseg.workflows.api.run_settings import RunSettings, read_run_settings
from moseg.workflows.config.pipeline_choices import ConfigLike, PipelineChoices
from moseg.workflows.config.trajectory_choices import TrajectoryChoices


@named_as_arguments()
def evaluate(
    dataset: str | os.PathLike = "synthetic",
    config: ConfigLike | None = None,
    *,
    variants: str | Variant | TrajectoryVariant | Iterable[str] = "fused",
    root: str | os.PathLike | None = None,
    sequences: str | Iterable[str] | None = None,
    list_file: str | os.PathLike | None = None,
    motions: int | str | None = None,
    preset: str | None = None,
    light: bool = False,
    quality: str | None = None,
    geometry: str | None = None,
    sensitivity: float | None = None,
    proposals: str | os.PathLike | None = None,
    depth: str | os.PathLike | None = None,
    flow: str | os.PathLike | None = None,
    tracks: str | os.PathLike | None = None,
    views: str | Iterable[str] | None = None,
    seed: int | None = None,
    seeds: int | None = None,
    report: str | os.PathLike | None = None,
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
) -> EvaluationReport | StillReport | TrajectoryReport:
    """Score variants of the pipeline on a data set: the same scores as `moseg eval`, from the same store.

    What is already in the store is not computed again; an interrupted call goes on from there when it is made again.

    Parameters
    ----------
    dataset : str or path
        Name of a data set, as `moseg datasets` lists them; or a folder of ``<sequence>/frames`` and
        ``<sequence>/masks``, which is the root of the data set ``folder``.
    config : PipelineConfig, mapping or path, optional
        As of `segment_video`.
    variants : str or iterable of str
        Rows of the ablation. Of frames: fused, oc-depth, oc, trajs, base; of labelled trajectories: fused, trajs,
        homography, affine.
    root : path, optional
        Folder of the data set; by default ``$MOSEG_DATA/<dataset>``.
    sequences : str or iterable of str, optional
        Only these; by default those of the published benchmark, or all that are there.
    list_file : path, optional
        File with the names of the sequences, one a line, in place of the data set's own list.
    motions : int, 'auto' or 'gt', optional
        Number of motions, the background's included; ``gt`` takes it from ground truth.
    preset, quality, geometry : str, optional
        As of `segment_video`.
    light : bool
        As of `segment_video`.
    sensitivity : float, optional
        As of `segment_video`.
    proposals, depth, flow, tracks : path, optional
        Folders of your own cues, as of `segment_video`; each sequence is looked for under its name below them.
    views : str or iterable of str, optional
        Of labelled trajectories: point models that ``fused`` combines.
    seed : int, optional
        Of labelled trajectories: seed of the random draws, 0 by default.
    seeds : int, optional
        Of labelled trajectories: number of seeds, from 0, over which means and spreads are taken.
    report : path, optional
        Also write a page of pictures, matrices, scores and times, as `moseg eval --report` does.
    store, workers, device, threads, batch, offline, non_commercial, accept_licence, progress
        As of `segment_video`.
    scheduler : str or path, optional
        Existing Dask cluster: ``tcp://host:8786``, ``tls://host:8786`` or a scheduler file.
    tls_ca, tls_cert, tls_key : path, optional
        PEM files for a scheduler at ``tls://``: the certificate of its authority, your own and its key.

    Returns
    -------
    EvaluationReport, StillReport or TrajectoryReport
        What `moseg eval --json` writes, percentages 0..100: of frames the first, of frames in which nothing moves the
        second, of labelled trajectories the third. Its ``notes`` say what must be known to read the scores rightly.

    Raises
    ------
    InputError
        The data set, a sequence, a parameter or a file cannot be used, or an argument has no meaning for the data set;
        the message is one line.
    StoreError, ClusterError
        The store or the worker processes failed.

    Examples
    --------
    >>> report = evaluate("davis16", root="DAVIS", sequences=["dog"], variants=["fused", "oc"])  # doctest: +SKIP
    >>> {row.variant: row.mean.F for row in report.rows}  # doctest: +SKIP
    {'fused': 88.2, 'oc': 81.9}
    """
    return _run(
        "eval",
        read_names("variants", variants),
        read_data(dataset, root, sequences, list_file),
        read_choices(
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
        ),
        read_trajectory_choices(views, seed, seeds),
        read_run_settings(
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
        ),
        report,
    )


@named_as_arguments()
def ablate(
    dataset: str | os.PathLike = "synthetic",
    config: ConfigLike | None = None,
    *,
    root: str | os.PathLike | None = None,
    sequences: str | Iterable[str] | None = None,
    list_file: str | os.PathLike | None = None,
    motions: int | str | None = None,
    preset: str | None = None,
    light: bool = False,
    quality: str | None = None,
    geometry: str | None = None,
    sensitivity: float | None = None,
    proposals: str | os.PathLike | None = None,
    depth: str | os.PathLike | None = None,
    flow: str | os.PathLike | None = None,
    tracks: str | os.PathLike | None = None,
    views: str | Iterable[str] | None = None,
    seed: int | None = None,
    seeds: int | None = None,
    report: str | os.PathLike | None = None,
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
) -> EvaluationReport | StillReport | TrajectoryReport:
    """Score all variants of the paper's ablation on a data set: the same scores as `moseg ablate`.

    Of frames: fused, oc-depth, oc, trajs and base. Of labelled trajectories: all views fused, and each of the three
    models alone.

    Parameters
    ----------
    dataset, config, root, ..., progress
        All as of `evaluate`, which has `variants` besides.

    Returns
    -------
    EvaluationReport, StillReport or TrajectoryReport
        A row for each variant, percentages 0..100.

    Raises
    ------
    InputError, StoreError, ClusterError
        As `evaluate`.

    Examples
    --------
    >>> report = ablate("synthetic", sequences="occlusion", workers=2)  # doctest: +SKIP
    >>> [row.variant for row in report.rows]  # doctest: +SKIP
    ['fused', 'oc-depth', 'oc', 'trajs', 'base']
    """
    return _run(
        "ablate",
        None,
        read_data(dataset, root, sequences, list_file),
        read_choices(
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
        ),
        read_trajectory_choices(views, seed, seeds),
        read_run_settings(
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
        ),
        report,
    )


def read_trajectory_choices(
    views: str | Iterable[str] | None, seed: int | None, seeds: int | None
) -> TrajectoryChoices:
    """Return what the arguments of a call say of labelled trajectories; raises InputError on one of another kind."""
    if seed is not None:
        check_min(0, seed=seed)
    if seeds is not None:
        check_min(1, seeds=seeds)
    return TrajectoryChoices(None if views is None else read_names("views", views), seed, seeds)


def _run(
    command: Literal["eval", "ablate"],
    variants: tuple[str, ...] | None,
    data: DataChoice,
    choices: PipelineChoices,
    trajectories: TrajectoryChoices,
    run: RunSettings,
    report: str | os.PathLike | None,
) -> EvaluationReport | StillReport | TrajectoryReport:
    check_kinds(Kind.PATH, optional=True, report=report)
    page = None if report is None else os.fsdecode(report)
    with kept_process_settings():
        return run_evaluation(command, data, choices, trajectories, run, variants, page=page, option="motions").report
