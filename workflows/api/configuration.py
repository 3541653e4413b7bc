"""Configurations from the arguments of a call."""

import os

from moseg.schemas.configs import PipelineConfig
from moseg.workflows.api.arguments import Kind, check_kinds, named_as_arguments
from moseg.workflows.config.pipeline_choices import CUES, Choice, ConfigLike, PipelineChoices


@named_as_arguments()
def load_config(
    config: ConfigLike | None = None,
    *,
    preset: str | None = None,
    light: bool = False,
    quality: str | None = None,
    geometry: str | None = None,
    motions: int | str | None = None,
    sensitivity: float | None = None,
) -> PipelineConfig:
    """Return the configuration that `segment_video` and `evaluate` run with for the same arguments.

    Parameters
    ----------
    config : PipelineConfig, mapping or path, optional
        A whole configuration; single parameters (``{"sections.length": 20}``) on top of the preset; or a YAML file of
        such, as `moseg config dump` writes it.
    preset : 'weights-free', 'paper' or 'modern', optional
        Set of backends, weights-free by default.
    light : bool
        Take the preset's lighter networks, for a laptop; only ``modern`` has them.
    quality : 'fast', 'default' or 'best', optional
        What accuracy may cost.
    geometry : 'default' or 'paper', optional
        Fits, affinity and clustering.
    motions : int, 'auto' or 'gt', optional
        Number of motions, the background's included; ``gt`` takes it from ground truth.
    sensitivity : float, optional
        Of proposals from dense tracks: divisor of the evidence that a moving object needs, 1 by default.

    Returns
    -------
    PipelineConfig
        Frozen and checked.

    Raises
    ------
    InputError
        There is no such preset, quality, geometry or parameter, a parameter cannot take a value, the file cannot be
        read, or a whole configuration comes with a preset that it would override.

    Examples
    --------
    >>> load_config({"flow.preset": "fine"}, motions=2).flow.preset
    'fine'
    """
    return read_choices(config, motions, preset, light, quality, geometry, sensitivity).make_config()


def read_choices(
    config: ConfigLike | None,
    motions: int | str | None,
    preset: str | None,
    light: bool,
    quality: str | None,
    geometry: str | None,
    sensitivity: float | None,
    **cues: str | os.PathLike | None,
) -> PipelineChoices:
    """Return what the arguments of a call say of the pipeline, with the folders of its own `cues`.

    Raises
    ------
    InputError
        An argument is of another kind.
    """
    check_kinds(Kind.TEXT, optional=True, preset=preset, quality=quality, geometry=geometry)
    check_kinds(Kind.TEXT_OR_COUNT, optional=True, motions=motions)
    check_kinds(Kind.SWITCH, light=light)
    check_kinds(Kind.NUMBER, optional=True, sensitivity=sensitivity)
    check_kinds(Kind.PATH, optional=True, **cues)
    folders = {cue: os.fsdecode(path) for cue, path in cues.items() if path is not None}
    chosen = [Choice(f"--{cue}", CUES[cue], "folder") for cue in folders]
    if motions is not None:
        chosen.append(Choice("--motions", "clustering.motions", str(motions)))
    if sensitivity is not None:
        chosen.append(Choice("--sensitivity", "track_objects.sensitivity", float(sensitivity)))
    return PipelineChoices(config, preset, quality, geometry, tuple(chosen), folders=folders, light=bool(light))
