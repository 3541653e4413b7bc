"""Zero-shot monocular motion segmentation: which pixels of a video move on their own.

    import moseg

    result = moseg.segment_video("holiday.mp4")
    result.labels  # uint16 (frame, y, x): 0 static, else an object's identity

What is here is imported when it is first used, so that ``import moseg`` itself costs nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from moseg.schemas.declared_names import find_names_by

if TYPE_CHECKING:
    from moseg.schemas.configs import PipelineConfig, Variant
    from moseg.schemas.errors import InputError, MosegError
    from moseg.workflows.api import MotionSegmentation, MovingObject, load_config, segment_video
    from moseg.workflows.exports import OverlayMode, OverlayStyle

__all__ = [
    "InputError",
    "MosegError",
    "MotionSegmentation",
    "MovingObject",
    "OverlayMode",
    "OverlayStyle",
    "PipelineConfig",
    "Variant",
    "__version__",
    "load_config",
    "segment_video",
]

_HOMES = {
    "InputError": "moseg.schemas.errors",
    "MosegError": "moseg.schemas.errors",
    "MotionSegmentation": "moseg.workflows.api",
    "MovingObject": "moseg.workflows.api",
    "OverlayMode": "moseg.workflows.exports",
    "OverlayStyle": "moseg.workflows.exports",
    "PipelineConfig": "moseg.schemas.configs",
    "Variant": "moseg.schemas.configs",
    "load_config": "moseg.workflows.api",
    "segment_video": "moseg.workflows.api",
}


# Before any room is imported: a parameter that takes the name of a method, or of a model, is checked against them.
find_names_by(lambda parameter: import_module("moseg.workflows.stages.registry").names_of(parameter))


def __getattr__(name: str):
    if name == "__version__":
        value = import_module("importlib.metadata").version("moseg")
    elif name in _HOMES:
        value = getattr(import_module(_HOMES[name]), name)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
