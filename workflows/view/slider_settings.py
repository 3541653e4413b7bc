"""Settings that the page offers: parameters that cost little to change once the cues are there."""

from typing import Any, NamedTuple

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.corrections import Corrections
from moseg.workflows.config.parameters import list_parameters, value_of

MAX_MOTIONS = 8
"""The largest number of motions that can be chosen."""


class Slider(NamedTuple):
    """A parameter on the page.

    Attributes
    ----------
    name : str
        ``stage.name``.
    label : str
    smallest, largest, step : float
        Of the slider; of its logarithm to base 10 the step, where it is logarithmic. Unused where there are options.
    is_log : bool
    is_share : bool
        Whether it is shown in percent.
    options : tuple
        Values of a choice in place of a slider.
    """

    name: str
    label: str
    smallest: float = 0.0
    largest: float = 0.0
    step: float = 0.0
    is_log: bool = False
    is_share: bool = False
    options: tuple[Any, ...] = ()


SLIDERS = (
    Slider("clustering.motions", "motions", options=("auto", *range(1, MAX_MOTIONS + 1))),
    Slider("clustering.threshold", "threshold", 0.02, 0.98, 0.02),
    Slider("affinity.scale", "affinity scale", 0.05, 10.0, 0.05, is_log=True),
    Slider("moving_objects.min_area", "smallest object", 0.0, 0.1, 0.001, is_share=True),
)


def list_settings(config: PipelineConfig, corrections: Corrections) -> list[dict[str, Any]]:
    """Return the sliders as JSON, with the values in force and those of the run's own configuration."""
    parameters = list_parameters()
    listed = []
    for slider in SLIDERS:
        parameter = parameters[slider.name]
        initial = value_of(config, parameter)
        listed.append(
            {
                "name": slider.name,
                "label": slider.label,
                "description": parameter.description,
                "unit": "px" if str(parameter.unit) == "px" else "",
                "initial": initial,
                "value": corrections.settings.get(slider.name, initial),
                "isChanged": slider.name in corrections.settings,
                "min": slider.smallest,
                "max": slider.largest,
                "step": slider.step,
                "isLog": slider.is_log,
                "isShare": slider.is_share,
                "options": list(slider.options),
            }
        )
    return listed
