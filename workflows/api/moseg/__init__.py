"""Zero-shot monocular motion segmentation: labels of the pixels of a video that move on their own.

    import moseg

    result = moseg.segment_video("holiday.mp4")
    result.labels  # uint16 (frame, y, x): 0 static, else an object's identity
    report = moseg.evaluate("synthetic")
    report.rows[0].mean.F  # percent

Each name is imported when it is first used, so that ``import moseg`` itself is fast.
"""

from collections.abc import Iterable
from importlib import import_module
from typing import TYPE_CHECKING

from moseg.schemas.declared_names import find_names_by

if TYPE_CHECKING:
    from moseg.schemas.configs import PipelineConfig, Variant
    from moseg.schemas.corrections import Corrections
    from moseg.schemas.errors import InputError, MosegError
    from moseg.schemas.parameters.plugins import Parameters
    from moseg.schemas.scores import EvaluationReport, StillReport
    from moseg.schemas.trajectory_scores import TrajectoryReport
    from moseg.workflows.api import (
        MotionSegmentation,
        MovingObject,
        ablate,
        evaluate,
        load_config,
        score,
        segment_video,
    )
    from moseg.workflows.exports import OverlayMode, OverlayStyle
    from moseg.workflows.plugins.registration import Method, register

__all__ = [
    "Corrections",
    "EvaluationReport",
    "InputError",
    "Method",
    "MosegError",
    "MotionSegmentation",
    "MovingObject",
    "OverlayMode",
    "OverlayStyle",
    "Parameters",
    "PipelineConfig",
    "StillReport",
    "TrajectoryReport",
    "Variant",
    "__version__",
    "ablate",
    "evaluate",
    "load_config",
    "register",
    "score",
    "segment_video",
]

_HOMES = {
    "Corrections": "moseg.schemas.corrections",
    "EvaluationReport": "moseg.schemas.scores",
    "InputError": "moseg.schemas.errors",
    "Method": "moseg.workflows.plugins.registration",
    "MosegError": "moseg.schemas.errors",
    "MotionSegmentation": "moseg.workflows.api",
    "MovingObject": "moseg.workflows.api",
    "OverlayMode": "moseg.workflows.exports",
    "OverlayStyle": "moseg.workflows.exports",
    "Parameters": "moseg.schemas.parameters.plugins",
    "PipelineConfig": "moseg.schemas.configs",
    "StillReport": "moseg.schemas.scores",
    "TrajectoryReport": "moseg.schemas.trajectory_scores",
    "Variant": "moseg.schemas.configs",
    "ablate": "moseg.workflows.api",
    "evaluate": "moseg.workflows.api",
    "load_config": "moseg.workflows.api",
    "register": "moseg.workflows.plugins.registration",
    "score": "moseg.workflows.api",
    "segment_video": "moseg.workflows.api",
}


def _find_names(parameter: str) -> Iterable[str]:
    """Return the names of the methods or models that a parameter accepts, including those of plug-ins."""
    import_module("moseg.workflows.plugins.loading").load_plugins()
    return import_module("moseg.workflows.stages.registry").names_of(parameter)


# Before any other package is imported, because the values of parameters are checked there.
find_names_by(_find_names)


def __getattr__(name: str):
    if name == "__version__":
        value = import_module("importlib.metadata").version("moseg")
    elif name in _HOMES:
        home = _HOMES[name]
        if home == "moseg.workflows.api" or name == "register":
            # Before configurations are checked while these modules are imported. Plug-ins themselves import `Method`.
            import_module("moseg.workflows.plugins.loading").load_plugins()
        value = getattr(import_module(home), name)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
