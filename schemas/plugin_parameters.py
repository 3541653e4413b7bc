"""Declaration of parameters that methods of plug-ins read."""

from pydantic.fields import FieldInfo

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters.plugins import Parameters, PluginParams


def declare_parameters(name: str, model: type[Parameters]) -> None:
    """Add parameters to configurations, as ``plugins.<name>.<parameter>``.

    Parameters
    ----------
    name : str
        Of the method, without dots, and not declared before.
    model : subclass of Parameters
        All of its fields have defaults.
    """
    PluginParams.model_fields[name] = FieldInfo.from_annotated_attribute(model, model())
    # In this order: the second schema contains the first.
    PluginParams.model_rebuild(force=True)
    PipelineConfig.model_rebuild(force=True)


def declared_parameters() -> tuple[str, ...]:
    """Return the names of the methods that have declared parameters."""
    return tuple(PluginParams.model_fields)
