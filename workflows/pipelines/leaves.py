"""The leaves of a graph from the sources of a sequence, or of a clip of trajectories."""

from collections.abc import Sequence
from itertools import chain

from moseg.schemas.configs import MOVING_SOURCES, PipelineConfig
from moseg.schemas.errors import InputError
from moseg.workflows.datasets import SequenceSource, TrajectorySource
from moseg.workflows.engine.ingest import IngestJob
from moseg.workflows.engine.session import Session
from moseg.workflows.engine.space import video_nbytes
from moseg.workflows.graph import GIVEN_SOURCES, SequenceLeaves, TrajectoryLeaves
from moseg.workflows.pipelines.hidden_scene import settle_hidden
from moseg.workflows.pipelines.repeated_frames import settle_repetitions
from moseg.workflows.pipelines.slow_motion import settle_gaps
from moseg.workflows.pipelines.source_choices import settle_choices
from moseg.workflows.pipelines.video_scenes import settle_cuts
from moseg.workflows.sources import MotionWeights, SceneFrames, working_size
from moseg.workflows.stages.motion_network import uses_motion_network
from moseg.workflows.stages.needed_packages import require_packages
from moseg.workflows.stages.needed_weights import needed_items

FRAMES_PER_JOB = 16


def ingest_sequences(
    session: Session, sources: Sequence[SequenceSource], config: PipelineConfig, annotated: bool
) -> list[SequenceLeaves]:
    """Return the leaves of every sequence: frames, cues that `config` takes as given, the annotation where asked.

    Each is one scene. Frames that repeat others and slow motion are found, and choices that `config` leaves open are
    settled. InputError is raised first where a package that it needs is missing.
    """
    leaves = settle_repetitions(session, _decode(session, sources, config, annotated), config)
    return list(settle_choices(session, settle_gaps(session, leaves, config), config))


def ingest_video(session: Session, source: SequenceSource, config: PipelineConfig) -> SequenceLeaves:
    """Return the same of a user's video, with what hides its scene and its cuts; the rest is settled for each scene."""
    (leaves,) = _decode(session, [source], config, annotated=False)
    leaves = settle_cuts(session, settle_hidden(session, leaves, config), config)
    scenes = settle_repetitions(session, leaves.scenes(), config)
    return leaves.joined(settle_choices(session, settle_gaps(session, scenes, config), config))


def _decode(
    session: Session, sources: Sequence[SequenceSource], config: PipelineConfig, annotated: bool
) -> list[SequenceLeaves]:
    """Return the leaves of every sequence before anything in the frames is looked for."""
    require_packages(config)
    plans = [ingest_jobs(source, config, annotated) for source in sources]
    decoded = [
        (source, job) for source, jobs in zip(sources, plans, strict=True) for job in chain.from_iterable(jobs.values())
    ]

    def estimate(places: Sequence[int]) -> float:
        return _estimate([decoded[place][0] for place in places], config)

    found = iter(session.ingest([job for _, job in decoded], estimate))
    leaves = []
    for source, jobs in zip(sources, plans, strict=True):
        ingested = {role: [next(found) for _ in group] for role, group in jobs.items()}
        leaves.append(make_leaves(source, ingested))
    # Last, so that a file that is not a video is reported before anything is fetched.
    weights = session.name_weights(needed_items(config))
    return [each._replace(weights=weights) for each in leaves]


def _estimate(sources: Sequence[SequenceSource], config: PipelineConfig) -> float:
    """Return about how many bytes the artifacts of these sequences, some given twice, take while they are analysed."""
    # Only where something is decoded: it imports the decoder of videos.
    from moseg.workflows.sources.likely_length import likely_num_frames

    frames = [source.frames for source in {source.name: source for source in sources}.values()]
    shapes = [working_size(each.describe().size, config.max_side) for each in frames]
    return sum(video_nbytes(likely_num_frames(each), shape) for each, shape in zip(frames, shapes, strict=True))


def ingest_jobs(source: SequenceSource, config: PipelineConfig, annotated: bool) -> dict[str, list[IngestJob]]:
    """Return what must be decoded for a sequence, by role."""
    # A scene is rendered whole for any of its sources.
    batch = f"scene {source.name}" if isinstance(source.frames, SceneFrames) else None
    jobs = {"frames": [IngestJob("frame", chunk, batch) for chunk in source.frames.chunks(FRAMES_PER_JOB)]}

    def add(role, kind, given, option):
        if given is None:
            raise InputError(f"{option} needs what the data set does not give", where=f"sequence {source.name}")
        jobs[role] = [IngestJob(kind, given, batch)]

    if annotated and source.annotations is not None:
        jobs["annotation"] = [IngestJob("annotation", source.annotations, batch)]
    elif annotated and source.labelled_points is not None:
        jobs["labelled_points"] = [IngestJob("labelled_points", source.labelled_points, batch)]
    if config.proposal_source in GIVEN_SOURCES:
        add("masks", "given_masks", source.objects or source.annotations, f"proposals: {config.proposal_source}")
    if config.depth.method in GIVEN_SOURCES:
        add("depth", "given_depth", source.depth, f"depth: {config.depth.method}")
    if config.flow.method in GIVEN_SOURCES:
        add("flow_forward", "given_flow", source.flow_forward, f"flow: {config.flow.method}")
        if config.proposal_source in MOVING_SOURCES:
            if config.flow.method == "folder" and source.flow_backward is None:
                raise InputError(
                    f"--proposals {config.proposal_source} needs flow in both directions",
                    where=f"the flow folder of sequence {source.name}",
                    expected="forward/ and backward/ in it, or other --proposals",
                )
            add("flow_backward", "given_flow", source.flow_backward, f"flow: {config.flow.method}")
    if config.tracks.method in GIVEN_SOURCES:
        add("tracks", "given_tracks", source.tracks, f"tracks: {config.tracks.method}")
    if uses_motion_network(config):
        add("motion_weights", "motion_weights", MotionWeights(config.motion_network.weights), "motion network")
    return jobs


def make_leaves(source: SequenceSource, ingested: dict[str, list[dict]]) -> SequenceLeaves:
    """Return the leaves of a sequence from the results of its jobs; raises InputError where these do not match."""
    where = f"sequence {source.name}"
    frames = tuple(chain.from_iterable(entry["leaves"] for entry in ingested["frames"]))
    shapes = {tuple(entry["shape"]) for entry in ingested["frames"]}
    if len(shapes) != 1:
        raise InputError("frames of different sizes", where=where, got=sorted(shapes), expected="one size")
    if len(frames) < 2:
        raise InputError("too few frames to see motion", where=where, got=len(frames), expected="at least 2")
    (shape,) = shapes
    annotation, labelled_points = (
        ingested[role][0] if role in ingested else None for role in ("annotation", "labelled_points")
    )
    num_motions, truth = source.num_motions, annotation or labelled_points
    if num_motions is None and truth is not None:
        num_motions = 1 + len(set(truth["labels"]) - {source.void})
    lists = {
        role: tuple(ingested[role][0]["leaves"])
        for role in ("depth", "flow_forward", "flow_backward")
        if role in ingested
    }
    for role, refs in lists.items():
        expected = len(frames) - (role != "depth")
        if len(refs) != expected:
            raise InputError(
                f"wrong number of {role.replace('_', ' ')} maps", where=where, got=len(refs), expected=expected
            )
    return SequenceLeaves(
        name=source.name,
        shape=shape,
        frames=frames,
        annotation=annotation["leaves"][0] if annotation else None,
        labelled_points=labelled_points["leaves"][0] if labelled_points else None,
        nothing_moves=source.nothing_moves,
        void=source.void,
        num_motions=num_motions,
        masks=ingested["masks"][0]["leaves"][0] if "masks" in ingested else None,
        masks_void=source.void if source.objects is None else source.objects_void,
        tracks=ingested["tracks"][0]["leaves"][0] if "tracks" in ingested else None,
        motion_weights=ingested["motion_weights"][0]["leaves"][0] if "motion_weights" in ingested else None,
        **lists,
    )


def ingest_trajectories(session: Session, sources: Sequence[TrajectorySource]) -> list[TrajectoryLeaves]:
    """Return the leaves of every clip; raises InputError where one cannot be read."""
    found = iter(session.ingest([job for source in sources for job in trajectory_jobs(source)]))
    return [make_trajectory_leaves(source, next(found), next(found)) for source in sources]


def trajectory_jobs(source: TrajectorySource) -> tuple[IngestJob, IngestJob]:
    """Return what must be decoded of a clip: its trajectories and their labels."""
    # They share a file: an error in it is reported once.
    batch = f"trajectories {source.name}"
    trajectories = IngestJob("trajectories", source.trajectories, batch, is_cheap=True)
    return trajectories, IngestJob("trajectory_labels", source.labels, batch, is_cheap=True)


def make_trajectory_leaves(source: TrajectorySource, trajectories: dict, labels: dict) -> TrajectoryLeaves:
    """Return the leaves of a clip from the results of its jobs."""
    return TrajectoryLeaves(
        name=source.name,
        trajectories=trajectories["leaves"][0],
        labels=labels["leaves"][0],
        num_motions=len(labels["labels"]),
        groups=source.groups,
    )
