"""The base of every model in this room: frozen, closed to unknown fields, finite."""

from collections.abc import Mapping
from typing import Any, Self

from pydantic import BaseModel, ConfigDict

from moseg.schemas.errors import UnnamedParameterError


class Frozen(BaseModel):
    """An immutable value that refuses unknown fields, NaN and infinity.

    NaN and infinity would be written to JSON as ``null`` and so collide under one digest.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    @classmethod
    def of_recipe(cls, values: Mapping[str, Any]) -> Self:
        """Return the parameters that a recipe names, without defaults for the others.

        A task may only depend on what is in its key. Where it reads a parameter that its recipe does not name, the
        default would be used whatever the user has set, so reading one is an error.

        Parameters
        ----------
        values : mapping
            Values by name, as in the recipe; models inside as mappings.

        Raises
        ------
        UnnamedParameterError
            When a field that `values` does not name is read, here or in a model inside.
        """
        params = cls.model_validate(values)
        _drop_defaults(params)
        return params

    def __getattr__(self, name: str) -> Any:
        # Python asks here only for what is not in the instance.
        if name in type(self).model_fields:
            raise UnnamedParameterError("parameter outside the recipe is read", where=type(self).__name__, got=name)
        return super().__getattr__(name)


def _drop_defaults(params: BaseModel) -> None:
    for name in type(params).model_fields:
        if name not in params.model_fields_set:
            del params.__dict__[name]
        elif isinstance(params.__dict__[name], BaseModel):
            _drop_defaults(params.__dict__[name])
