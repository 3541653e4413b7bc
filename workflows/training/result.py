"""The result of a training: an ONNX file, and beside it the recipe by which it was made."""

import hashlib
import json
from importlib.metadata import version
from pathlib import Path
from platform import python_version
from typing import TYPE_CHECKING, Any, NamedTuple

from moseg.schemas.errors import InputError
from moseg.workflows.exports.write_text import check_writable, write_text
from moseg.workflows.process.atomic_write import atomic_path, blame_output

if TYPE_CHECKING:
    from moseg.tasks.motion_network.unet import MotionUNet

SUFFIX = ".onnx"
_PACKAGES = ("moseg", "torch", "onnx", "numpy", "opencv-python-headless", "poselib")


class Trained(NamedTuple):
    """Files of a trained network, and the last entry of its curve."""

    onnx: Path
    recipe: Path
    scores: dict[str, float | None]


def check_result(out: str) -> Path:
    """Return the path of the ONNX file to write, after a check that it and its recipe can be written.

    Raises
    ------
    InputError
        They cannot, or the name does not end in ``.onnx``.
    """
    path = Path(out)
    if path.suffix != SUFFIX:
        raise InputError("not a name of a network", where="--out", got=repr(out), expected=f"a name ending in {SUFFIX}")
    for each in (path, _recipe_path(path)):
        check_writable(each)
    return path


def write_result(
    network: "MotionUNet", path: Path, settings: dict[str, Any], curve: list[dict[str, float | None]]
) -> Trained:
    """Write a network and the recipe by which it was made; raises InputError if they cannot be written."""
    from moseg.tasks.motion_network.export import to_onnx

    content = to_onnx(network.cpu().eval())
    recipe = {
        **settings,
        "result": {"sha256": hashlib.sha256(content).hexdigest(), "bytes": len(content), **curve[-1]},
        "versions": {"python": python_version(), **{name: version(name) for name in _PACKAGES}},
        "licence": "MIT",
    }
    with atomic_path(path) as temporary, blame_output(path):
        temporary.write_bytes(content)
    write_text(_recipe_path(path), json.dumps(recipe, indent=1) + "\n")
    return Trained(path, _recipe_path(path), curve[-1])


def _recipe_path(path: Path) -> Path:
    return path.with_suffix(".json")
