"""What a user must know to read a result rightly."""

from moseg.schemas.configs import PipelineConfig


def motions_note(config: PipelineConfig, option: str = "--motions") -> tuple[str, ...]:
    """A warning where the number of motions is looked for in affinities that do not tell it; `option` would give it."""
    if config.affinity.method == "ork" and config.clustering.motions == "auto":
        return (f"ordered residuals rank and do not tell the number of motions: give it by {option}",)
    return ()
