"""The parameters of the pipeline as a list: what each means, in which unit and range, and what it is by default."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from moseg.schemas.choices import ChoiceOf
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.plugin_parameters import declared_parameters
from moseg.schemas.units import Unit

_SIGNS = {"ge": ">=", "gt": ">", "le": "<=", "lt": "<"}


@dataclass(frozen=True)
class Parameter:
    """A single parameter.

    Attributes
    ----------
    path : tuple of str
        Stages from the outermost, and the name.
    default : object
        As `PipelineConfig` has it.
    kind : type
        Annotation of its field.
    unit : Unit or None
        None where it is not a number.
    description : str
        Without the unit.
    """

    path: tuple[str, ...]
    default: Any
    kind: Any
    unit: Unit | None
    description: str

    @property
    def name(self) -> str:
        """``stage.name``, as `--set` takes it."""
        return ".".join(self.path)

    @property
    def values(self) -> str:
        """Range or choices: ``>= 1``, ``0 to 1``, ``dis, raft``, ``true or false``."""
        return _values(self.kind)

    @property
    def choices(self) -> tuple[str, ...]:
        """Names that it may be; empty unless it is a name out of a set. Plug-ins may add some."""
        return tuple(_choices(self.kind))


def list_parameters() -> Mapping[str, Parameter]:
    """Return every parameter of the pipeline by ``stage.name``, in the order of the stages; last those of plug-ins."""
    return _list_parameters(declared_parameters())


def list_stages() -> Mapping[str, str]:
    """Return what the parameters of every stage are about; a stage within a stage as ``clustering.count``."""
    return _list_stages(declared_parameters())


@cache
def _list_parameters(of_plugins: tuple[str, ...]) -> Mapping[str, Parameter]:
    return {parameter.name: parameter for parameter in _walk(PipelineConfig(), ())}


@cache
def _list_stages(of_plugins: tuple[str, ...]) -> Mapping[str, str]:
    return dict(_walk_stages(PipelineConfig, ()))


def value_of(config: PipelineConfig, parameter: Parameter) -> Any:
    """Return a parameter's value."""
    value: Any = config
    for name in parameter.path:
        value = getattr(value, name)
    return value


def stage_model(field: FieldInfo) -> type[BaseModel] | None:
    """Return the model of a field that holds parameters of its own; None where the field is a parameter."""
    kind = field.annotation
    return kind if isinstance(kind, type) and issubclass(kind, BaseModel) else None


def _walk(defaults: BaseModel, path: tuple[str, ...]) -> Iterator[Parameter]:
    for name, field in type(defaults).model_fields.items():
        # A stage may have other defaults for the parameters of a stage within it than that stage has alone.
        default = getattr(defaults, name)
        if stage_model(field) is not None:
            yield from _walk(default, (*path, name))
            continue
        unit = next((each for each in field.metadata if isinstance(each, Unit)), None)
        kind = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
        description = (field.description or "").removesuffix(f", {unit}")
        yield Parameter((*path, name), default, kind, unit, description)


def _walk_stages(model: type[BaseModel], path: tuple[str, ...]) -> Iterator[tuple[str, str]]:
    for name, field in model.model_fields.items():
        inner = stage_model(field)
        if inner is not None and inner.model_fields:
            yield ".".join((*path, name)), " ".join((inner.__doc__ or "").partition("\n\n")[0].split())
            yield from _walk_stages(inner, (*path, name))


def _choices(kind: Any) -> Iterator[str]:
    if get_origin(kind) is Annotated:
        inner, *metadata = get_args(kind)
        declared = [each for each in metadata if isinstance(each, ChoiceOf)]
        yield from declared[0].names if declared else _choices(inner)
    elif get_origin(kind) is Literal:
        yield from get_args(kind)
    elif get_origin(kind) in (Union, UnionType):
        for each in get_args(kind):
            yield from _choices(each)


def _values(kind: Any, bounds: tuple = ()) -> str:
    origin, arguments = get_origin(kind), get_args(kind)
    if origin is Annotated:
        inner, *metadata = arguments
        # A field within an annotation carries its bounds along.
        metadata = [each for item in metadata for each in (item.metadata if isinstance(item, FieldInfo) else [item])]
        declared = [each for each in metadata if isinstance(each, ChoiceOf)]
        return ", ".join(declared[0].names) if declared else _values(inner, (*bounds, *metadata))
    if origin is Literal:
        return ", ".join(map(str, arguments))
    if origin in (Union, UnionType):
        return " or ".join(_values(each) for each in arguments)
    if origin is tuple:
        return f"list of {_values(arguments[0])}"
    if kind in (int, float):
        return _range(bounds)
    words = {bool: "true or false", str: "text", NoneType: "null"}
    # Plug-ins may declare other kinds.
    return words.get(kind) or getattr(kind, "__name__", str(kind))


def _range(bounds: tuple) -> str:
    # Of pydantic's bounds each is an object with one attribute.
    found = {sign: getattr(each, sign) for each in bounds for sign in _SIGNS if hasattr(each, sign)}
    if found.keys() == {"ge", "le"}:
        return f"{found['ge']} to {found['le']}"
    return " and ".join(f"{_SIGNS[sign]} {found[sign]}" for sign in _SIGNS if sign in found) or "any number"
