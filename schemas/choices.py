"""Parameters whose values are names that stages, registries and plug-ins declare."""

from dataclasses import dataclass
from typing import Any

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from moseg.schemas.declared_names import declared_names


@dataclass(frozen=True)
class ChoiceOf:
    """Annotation of a parameter that accepts one of the names declared for it.

    Attributes
    ----------
    parameter : str
        ``stage.name``, as in ``--set``.
    """

    parameter: str

    @property
    def names(self) -> tuple[str, ...]:
        """Declared names, in the order of the declarations."""
        return declared_names(self.parameter)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_after_validator_function(self._check, handler(source))

    def _check(self, value: str) -> str:
        names = self.names
        if value not in names:
            *others, last = map(repr, names)
            expected = f"{', '.join(others)} or {last}" if others else last
            raise PydanticCustomError("literal_error", "Input should be {expected}", {"expected": expected})
        return value
