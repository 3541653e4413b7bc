"""Parameters of the methods that plug-ins add."""

from typing import Any

from moseg.schemas.frozen import Frozen


class Parameters(Frozen):
    """Base class of the parameters of a plug-in's method: pydantic fields with defaults and descriptions."""


class PluginParams(Frozen):
    """Parameters of methods that plug-ins add, by the method's name; fields are added as plug-ins are registered."""

    def __getattr__(self, name: str) -> Any:
        # A configuration may have been made before the plug-in was registered.
        field = type(self).model_fields.get(name)
        return super().__getattr__(name) if field is None else field.default
