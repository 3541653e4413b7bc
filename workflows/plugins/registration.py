"""Registration of what a plug-in declares, beside what this project has."""

import sys
from dataclasses import replace
from typing import NamedTuple

from moseg.schemas.errors import InputError
from moseg.tasks.motion_models import FLOW_MODELS
from moseg.tasks.motion_models.flow_model import FlowModel
from moseg.tasks.point_models import POINT_MODELS
from moseg.tasks.point_models.point_model import PointModel
from moseg.workflows.datasets import DATASETS
from moseg.workflows.datasets.dataset import FrameLayout, TrajectoryLayout
from moseg.workflows.exports.formats import FORMATS, ExportFormat
from moseg.workflows.plugins.code import code_of_plugin
from moseg.workflows.plugins.registered import Registered, entries
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
    """

    task: Task
    about: str
    licence: str = "plug-in"


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
    if not isinstance(declared, Declared):
        expected = "a Method, a FlowModel, a PointModel, the layout of a data set, or an ExportFormat"
        raise InputError("nothing that a plug-in can add", where=where, got=repr(declared), expected=expected)
    if isinstance(declared, Method):
        task = declared.task
        functions = {"params": task.params, "run or run_together": task.run or task.run_together}
        for name, function in functions.items():
            if not callable(function):
                place = f"{task.name} by {task.method} of {where}"
                raise InputError(f"{name} that is no function", where=place, got=repr(function), expected="a function")


def add_entry(entry: Registered) -> None:
    """Add one declaration of a plug-in to this project's own; see `register`."""
    declared = entry.declared
    if isinstance(declared, Method):
        backend = Backend(declared.task.method, declared.about, declared.licence, declared.task.network)
        add_method(find_stage(declared.task.name).name, replace(declared.task, code=entry.code), backend)
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


def _insert(names: dict, declared: Declared, kind: str) -> None:
    if declared.name in names:
        raise InputError(f"{kind} exists", where="plug-in", got=declared.name, expected="another name")
    names[declared.name] = declared
