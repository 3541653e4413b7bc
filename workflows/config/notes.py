"""What a user must know to read a result rightly."""

from collections.abc import Sequence

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant, Variant


def motions_note(config: PipelineConfig, option: str = "--motions") -> tuple[str, ...]:
    """Return a warning where `auto` counts motions in affinities that do not show their number; `option` gives it."""
    if config.affinity.method == "ork" and config.clustering.motions == "auto":
        return (f"ordered residuals do not show the number of motions: give it by {option}",)
    return ()


def evaluation_notes(config: PipelineConfig, variants: Sequence[Variant], option: str = "--motions") -> tuple[str, ...]:
    """Return what the scores on a data set of frames depend on; `option` gives the number of motions."""
    proposals = config.proposal_source
    if proposals == "detections":
        chosen = config.detections
        named = chosen.tagger if chosen.tags is None else f"tags {', '.join(chosen.tags)}"
        proposals += f" ({named}; grounding-dino; {chosen.masks}; {chosen.tracker})"
    elif proposals == "sam3":
        proposals += f" ({', '.join(config.named_objects)}; {config.detections.tracker})"
    elif proposals == "motion-prompts":
        proposals += f" ({config.detections.masks}; {config.detections.tracker})"
    notes = [f"proposals {proposals}, flow {config.flow.method}, tracks {config.tracks.method}"]
    if config.depth.method == "none":
        without = [variant.value for variant in (Variant.FUSED, Variant.OC_DEPTH, Variant.OC) if variant in variants]
        if without:
            notes.append(f"no depth given: {', '.join(without)} ran without it (oc-depth with constant inverse depth)")
    else:
        notes.append(f"depth {config.depth.method}")
    return (*notes, *motions_note(config, option))


def trajectory_notes(
    config: PipelineConfig, variants: Sequence[TrajectoryVariant], seeds: Sequence[int] | None
) -> tuple[str, ...]:
    """Return what the errors on labelled trajectories depend on."""
    motions = config.clustering.motions
    notes = [f"number of motions: {'given (gt)' if motions == 'gt' else motions}"]
    if TrajectoryVariant.FUSED in variants:
        notes.append(f"views of fused: {', '.join(config.fused_point_models)}")
    if seeds is not None:
        notes.append(f"mean over seeds {', '.join(map(str, seeds))}")
    return tuple(notes)
