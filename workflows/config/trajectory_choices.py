"""Choices of evaluations on labelled trajectories, and which of the others have no meaning there."""

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant
from moseg.schemas.errors import InputError
from moseg.schemas.spelling import closest
from moseg.workflows.config.parameters import list_parameters, value_of
from moseg.workflows.config.pipeline_choices import PipelineChoices, are_equal

READ_PARAMETERS = (
    "fused_point_models",
    "clustering.motions",
    "noise_reduction.",
    "hypotheses.",
    "kernel.",
    "clip_sections.",
    "trajectory_clustering.",
)
"""Parameters, and stages of parameters, that trajectories without images read."""
SEED = "hypotheses.seed"
DEFAULT_NAMES = {"preset": "weights-free", "quality": "default", "geometry": "default", "light": False}


@dataclass(frozen=True)
class TrajectoryChoices:
    """Views and seeds, of labelled trajectories only.

    Attributes
    ----------
    views : tuple of str or None
        Point models that ``fused`` combines; those of the configuration where None.
    seed : int or None
        Of the random draws; that of the configuration where None.
    seeds : int or None
        Number of seeds, from 0, to average over; a single run where None.
    """

    views: tuple[str, ...] | None = None
    seed: int | None = None
    seeds: int | None = None

    @property
    def all_seeds(self) -> range | None:
        """Seeds to average over; None where a single run is asked for."""
        return None if self.seeds is None else range(self.seeds)

    def refuse(self, dataset: str, expected: Iterable[str]) -> None:
        """Raise InputError where one is given for a data set of frames; `expected` names those of trajectories."""
        for name in ("views", "seed", "seeds"):
            if getattr(self, name) is not None:
                where, got = f"--{name}", f"data set {dataset}"
                known = " or ".join(expected)
                raise InputError("an option of labelled trajectories", where=where, got=got, expected=known)

    def apply(
        self, choices: PipelineChoices, config: PipelineConfig, dataset: str, variants: Collection[TrajectoryVariant]
    ) -> PipelineConfig:
        """Return the configuration with these choices.

        Raises
        ------
        InputError
            Another choice needs images or says otherwise, or one of these has no meaning for the variants.
        """
        _refuse_images(choices, dataset)
        if self.seed is not None and self.seeds is not None:
            raise InputError("two choices", where="--seed", got=f"--seeds {self.seeds} too", expected="one of them")
        self._refuse_settings(choices)
        if self.views is not None and TrajectoryVariant.FUSED not in variants:
            got = f"--variant {','.join(variants)}"
            raise InputError(
                "an option of variant fused", where="--views", got=got, expected="fused among the variants"
            )
        chosen = {}
        if self.views is not None:
            chosen["fused_point_models"] = self.views
        if self.seed is not None:
            chosen["hypotheses"] = config.hypotheses.model_copy(update={"seed": self.seed})
        config = config.model_copy(update=chosen)
        _check_views(config.fused_point_models, "fused_point_models" if self.views is None else "--views")
        _check_draws(config, variants)
        return config

    def _refuse_settings(self, choices: PipelineChoices) -> None:
        """Raise InputError where `--set` gives a parameter another value than one of these options."""
        parameters = {"views": "fused_point_models", "seed": SEED, "seeds": SEED}
        given = {parameters[name]: f"--{name}" for name in parameters if getattr(self, name) is not None}
        values = {"fused_point_models": self.views, SEED: self.seed}
        for name, value in dict(choices.settings).items():
            if name in given and (values[name] is None or not are_equal(name, value, values[name])):
                got = f"--set {name}={value} too"
                raise InputError("two choices", where=given[name], got=got, expected="one of them")


def _check_views(names: Sequence[str], where: str) -> None:
    """Raise InputError unless the names are different point models of points without depth."""
    from moseg.tasks.point_models import POINT_MODELS

    known = [name for name, model in POINT_MODELS.items() if not model.needs_depth]
    if not names or not set(names) <= set(known) or len(set(names)) < len(names):
        unknown = [name for name in names if name not in known]
        close = closest(unknown[0], known) if unknown else None
        expected = f"different ones of {', '.join(known)}, separated by commas"
        expected += "" if close is None else f"; did you mean {close!r}?"
        raise InputError("not point models", where=where, got=",".join(names), expected=expected)


def _check_draws(config: PipelineConfig, variants: Iterable[TrajectoryVariant]) -> None:
    """Raise InputError where the number of motions is to be found by draws of which a variant has only one."""
    if config.clustering.motions != "auto" or config.trajectory_clustering.auto != "stability":
        return
    what = "too few draws to compare"
    where, expected = "trajectory_clustering.auto=stability", "another method for the number, or the number"
    if config.hypotheses.num_draws < 2:
        raise InputError(what, where=where, got="hypotheses.num_draws=1", expected=expected)
    for variant in variants:
        # Spectral clustering, which a single view always has, gives one grouping.
        if len(config.point_models(variant)) < 2 or config.trajectory_clustering.method != "energy":
            got = f"variant {variant}, which is clustered spectrally"
            raise InputError(what, where=where, got=got, expected=expected)


def _refuse_images(choices: PipelineChoices, dataset: str) -> None:
    """Raise InputError where a choice is given that applies only to frames."""
    got = f"data set {dataset}, trajectories without images"
    for option in _options_for_images(choices):
        raise InputError("an option for images", where=option, got=got, expected="a data set of frames")
    for name, _ in choices.settings:
        if not name.startswith(READ_PARAMETERS):
            expected = " or ".join(name.removesuffix(".") for name in READ_PARAMETERS)
            raise InputError("a parameter for images", where=f"--set {name}", got=got, expected=expected)
    # A full file has all parameters; those at their default change nothing.
    given = choices.given_config()
    for name, parameter in list_parameters().items():
        if not name.startswith(READ_PARAMETERS) and value_of(given, parameter) != parameter.default:
            where = f"{choices.config}: {name}" if choices.is_file else name
            raise InputError("a parameter for images", where=where, got=got, expected="its default, or none")


def _options_for_images(choices: PipelineChoices) -> Iterator[str]:
    """Yield the options that were given and apply only to frames."""
    yield from (f"--{kind}" for kind, name in choices.names.items() if name != DEFAULT_NAMES[kind])
    yield from (choice.option for choice in choices.chosen if not choice.parameter.startswith(READ_PARAMETERS))
