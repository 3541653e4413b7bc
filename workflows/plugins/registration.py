"""Registration of what a plug-in declares, beside what this project has."""

import re
import sys
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from inspect import signature
from typing import NamedTuple

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.schemas.parameters.plugins import Parameters
from moseg.schemas.plugin_parameters import declare_parameters, declared_parameters
from moseg.tasks.motion_models import FLOW_MODELS
from moseg.tasks.motion_models.flow_model import FlowModel
from moseg.tasks.point_models import POINT_MODELS
from moseg.tasks.point_models.point_model import PointModel
from moseg.workflows.datasets import DATASETS
from moseg.workflows.datasets.dataset import FrameLayout, TrajectoryLayout
from moseg.workflows.exports.formats import FORMATS, ExportFormat
from moseg.workflows.plugins.code import code_of_plugin
from moseg.workflows.plugins.registered import Registered, entries
from moseg.workflows.stages.merits import GIVEN
from moseg.workflows.stages.model_codes import set_model_code
from moseg.workflows.stages.registry import add_method, find_stage
from moseg.workflows.stages.stage import Backend
from moseg.workflows.stages.task import Task


class Method(NamedTuple):
    """Method of a stage: an affinity, a backend of flow, depth or tracks, a tagger, an outliner, a tracker.

    Attributes
    ----------
    task : Task
        Task that names the stage and the method, and computes its result.
    about : str
        Description in words, for `moseg backends`.
    licence : str
        Owner and licence of the code, for `moseg backends`.
    parameters : subclass of moseg.Parameters, optional
        Parameters of the method, all with defaults: ``--set plugins.<method>.<parameter>=VALUE``. The task reads their
        values as ``params["parameters"]``, and they are part of its keys.
    """

    task: Task
    about: str
    licence: str = "plug-in"
    parameters: type[Parameters] | None = None


RESERVED = (*GIVEN, "auto")
"""Values of parameters that stand for something else than a method of a stage."""
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")

Declared = Method | FlowModel | PointModel | FrameLayout | TrajectoryLayout | ExportFormat


def register(*declared: Declared) -> None:
    """Add data sets, exports, motion models and methods of stages to those of this project.

    Options, configurations, help and completion then accept their names. The keys of the artifacts of a method or a
    motion model contain the fingerprint of its code (see `code_of_plugin`), so that a change of the code computes the
    artifacts anew. An object that is registered already is left as it is. Worker processes receive the objects that are
    registered here. A package that is to be registered in every process names its objects in an entry point of the
    group ``moseg.plugins``.

    Parameters
    ----------
    *declared : Method, FlowModel, PointModel, data set layout or ExportFormat

    Raises
    ------
    InputError
        A name is taken, a method belongs to no stage, the plug-in's code is in no file, or an object is of none of
        these kinds.

    Examples
    --------
    >>> from moseg.workflows.datasets.two_trees import TwoTrees
    >>> layout = TwoTrees("my-benchmark", "frames", "masks", "instance", 255, None, None, "masks", "https://example.org")
    >>> moseg.register(layout)  # doctest: +SKIP
    """
    caller = sys._getframe(1).f_globals["__name__"]
    for each in declared:
        check_kind(each, caller)
        if all(entry.declared is not each for entry in entries):
            add_entry(Registered(each, *code_of_plugin(each, caller), is_installed=False))


def check_kind(declared: object, where: str) -> None:
    """Raise InputError unless an object is of a kind that can be registered."""
    if isinstance(declared, type) or not isinstance(declared, Declared):
        expected = "a Method, a FlowModel, a PointModel, the layout of a data set, or an ExportFormat (no class)"
        raise InputError("nothing that a plug-in can add", where=where, got=repr(declared), expected=expected)
    if isinstance(declared, Method):
        place = f"{declared.task.name} by {declared.task.method} of {where}"
        _check_task(declared.task, place)
        if declared.parameters is not None:
            _check_parameters(declared.parameters, declared.task.method, place)
    elif isinstance(declared, PointModel):
        _check_point_model(declared, f"{declared.name} of {where}")


def _check_task(task: Task, where: str) -> None:
    """Raise InputError if a task's method, version or functions cannot be what they stand for."""
    if not _NAME.fullmatch(task.method) or task.method in RESERVED:
        expected = f"letters, digits, '.', '-' and '_', and none of {', '.join(RESERVED)}"
        raise InputError("no name for a method", where=where, got=repr(task.method), expected=expected)
    if type(task.version) is not int or task.version < 1:
        raise InputError("wrong version", where=where, got=repr(task.version), expected="a whole number from 1")
    functions = {"params": task.params, "run or run_together": task.run or task.run_together}
    for name, function in functions.items():
        if not callable(function):
            raise InputError(f"{name} that is no function", where=where, got=repr(function), expected="a function")
    computed, arguments = ("run_together", ("params", "inputs"))
    if task.run_together is None:
        computed, arguments = "run", ("params", "inputs", "rng")
    try:
        signature(task.run_together or task.run).bind(*arguments)
    except TypeError as error:
        expected = f"{computed}({', '.join(arguments)})"
        raise InputError(f"{computed} of other arguments", where=where, got=error, expected=expected) from error


def _check_parameters(model: type[Parameters], method: str, where: str) -> None:
    """Raise InputError if parameters cannot be part of a configuration."""
    if not isinstance(model, type) or not issubclass(model, Parameters):
        expected = "a subclass of moseg.Parameters"
        raise InputError("parameters that are none", where=where, got=repr(model), expected=expected)
    if "." in method:
        expected = "no dot in the name of a method that has parameters"
        raise InputError("no name for parameters", where=where, got=repr(method), expected=expected)
    without = [name for name, field in model.model_fields.items() if field.is_required()]
    if without:
        raise InputError("a parameter without a default", where=where, got=without[0], expected="defaults of all")


def _check_point_model(model: PointModel, where: str) -> None:
    """Raise InputError if samples of a point model cannot be drawn."""
    for name, is_right, expected in (
        ("sample_size", model.sample_size >= 1, "1 or more"),
        ("num_frames", model.num_frames in (2, 3), "2 or 3"),
    ):
        if not is_right:
            raise InputError(f"wrong {name}", where=where, got=getattr(model, name), expected=expected)


def add_entry(entry: Registered) -> None:
    """Add one declaration of a plug-in to this project's own; see `register`."""
    declared = entry.declared
    if isinstance(declared, Method):
        _add_method(declared, entry.code)
    elif isinstance(declared, FlowModel):
        _insert(FLOW_MODELS, declared, "flow model")
        set_model_code("flow", declared.name, entry.code)
    elif isinstance(declared, ExportFormat):
        _insert(FORMATS, declared, "export format")
    elif isinstance(declared, FrameLayout | TrajectoryLayout):
        _insert(DATASETS, declared, "data set")
    else:
        _insert(POINT_MODELS, declared, "point model")
        set_model_code("point", declared.name, entry.code)
    entries.append(entry)


def _add_method(declared: Method, code: str) -> None:
    task, name = replace(declared.task, code=code), declared.task.method
    if declared.parameters is not None:
        if name in declared_parameters():
            raise InputError("parameters of this name exist", where="plug-in", got=name, expected="another name")
        task = replace(task, params=partial(_read_params, task.params, name))
    backend = Backend(name, declared.about, declared.licence, task.network)
    add_method(find_stage(task.name).name, task, backend)
    if declared.parameters is not None:
        declare_parameters(name, declared.parameters)


def _read_params(read: Callable[..., dict], name: str, config: PipelineConfig, **place) -> dict:
    """Return what a task reads of the configuration, with the parameters of its own."""
    return {**read(config, **place), "parameters": getattr(config.plugins, name).model_dump(mode="json")}


def _insert(names: dict, declared: Declared, kind: str) -> None:
    if declared.name in names:
        raise InputError(f"{kind} exists", where="plug-in", got=declared.name, expected="another name")
    names[declared.name] = declared
