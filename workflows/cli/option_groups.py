"""Commands whose parameters are groups of options: each group a dataclass, and a panel of the command's help."""

import inspect
from collections.abc import Callable
from copy import copy
from dataclasses import Field, fields, is_dataclass
from functools import wraps
from typing import Annotated, Any, get_args, get_type_hints

from typer.models import ParameterInfo


def with_option_groups(function: Callable[..., None]) -> Callable[..., None]:
    """Return the function with each parameter that is a group of options replaced by the group's options.

    A group's ``PANEL``, if it has one, is the heading of its options in the help.
    """
    parameters, groups = [], {}
    for parameter in inspect.signature(function, eval_str=True).parameters.values():
        group = parameter.annotation
        if not is_dataclass(group):
            parameters.append(parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY))
            continue
        groups[parameter.name] = group
        hints = get_type_hints(group, include_extras=True)
        parameters.extend(_parameter(field, hints[field.name], group) for field in fields(group))

    @wraps(function)
    def command(**values):
        grouped = {
            name: group(**{field.name: values.pop(field.name) for field in fields(group)})
            for name, group in groups.items()
        }
        return function(**grouped, **values)

    command.__signature__ = inspect.Signature(parameters)
    command.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    return command


def _parameter(field: Field, hint: Any, group: type) -> inspect.Parameter:
    """Return the parameter of a group's field, under the group's heading."""
    kind, *metadata = get_args(hint)
    # Copied, because an option that groups share stands under another heading in each.
    options = [copy(each) for each in metadata]
    for option in options:
        if isinstance(option, ParameterInfo) and option.rich_help_panel is None:
            option.rich_help_panel = getattr(group, "PANEL", None)
    return inspect.Parameter(
        field.name, inspect.Parameter.KEYWORD_ONLY, default=field.default, annotation=Annotated[kind, *options]
    )
