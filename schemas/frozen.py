"""The base class of all schemas: frozen, without unknown fields, finite."""

from collections.abc import Callable, Mapping
from typing import Any, Self, TypeVar

from pydantic import BaseModel, ConfigDict

from moseg.schemas.errors import UnnamedParameterError

Model = TypeVar("Model", bound=BaseModel)


class Frozen(BaseModel):
    """An immutable value without unknown fields, NaN and infinity.

    In JSON, NaN and infinity would both be ``null`` and have the same digest.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    @classmethod
    def of_recipe(cls, values: Mapping[str, Any]) -> Self:
        """Return the parameters that a recipe names, without defaults for the others.

        A task may only depend on what is in its key. If it read a parameter outside its recipe, it would get the
        default, not the user's value, so reading one is an error.

        Parameters
        ----------
        values : mapping
            Values by name, as in the recipe; nested models as mappings.

        Raises
        ------
        UnnamedParameterError
            When a field that `values` does not contain is read, here or in a nested model.
        """
        params = cls.model_validate(values)
        _drop_defaults(params)
        return params

    def __getattr__(self, name: str) -> Any:
        # Python calls this only for attributes that the instance does not have.
        if name in type(self).model_fields:
            raise UnnamedParameterError("parameter outside the recipe is read", where=type(self).__name__, got=name)
        return super().__getattr__(name)


def _drop_defaults(params: BaseModel) -> None:
    """Delete the fields that were not set explicitly, here and in nested models."""
    for name in type(params).model_fields:
        if name not in params.model_fields_set:
            del params.__dict__[name]
        elif isinstance(params.__dict__[name], BaseModel):
            _drop_defaults(params.__dict__[name])


def with_defaults(**values: Any) -> Callable[[type[Model]], type[Model]]:
    """Return a decorator of a model class that gives inherited fields other defaults.

    Unlike the values of a default instance of the base, they hold for what is not given beside values that are.
    """

    def change(model: type[Model]) -> type[Model]:
        for name, value in values.items():
            model.model_fields[name].default = value
        model.model_rebuild(force=True)
        return model

    return change
