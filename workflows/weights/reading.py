"""Readers of a weights item's files: tensors and documents from which a network is built."""

import os
import re
import struct
import warnings
import zipfile
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from moseg.schemas.errors import InputError
from moseg.schemas.weights import TENSOR_SUFFIXES, WeightsItem

if TYPE_CHECKING:
    import torch

    from moseg.tasks.networks import Checkpoint

PACKAGES = ("torch", "transformers", "safetensors")
"""The libraries that networks run on; nothing else needs them."""
ARCHIVE = b"PK\x03\x04"
"""The beginning of a zip file, which torch saves."""


def require_network_packages() -> None:
    """Raise InputError, with the command that installs them, if a library that networks need is missing."""
    missing = [name for name in PACKAGES if find_spec(name) is None]
    if missing:
        expected = "pip install 'moseg[models]'"
        raise InputError(f"networks need {' and '.join(missing)}", got="not installed", expected=expected)


def read_checkpoint(item: WeightsItem, folder: Path) -> "Checkpoint":
    """Return tensors and documents of an item whose files were checked.

    Raises
    ------
    InputError
        A file is not what its suffix says, or changed meanwhile.
    """
    from moseg.tasks.networks import Checkpoint

    tensors: Mapping[str, torch.Tensor] = {}
    documents = {}
    for file in item.files:
        path = folder / file.name
        if file.name.endswith(TENSOR_SUFFIXES):
            # Copied from the file's pages: a network must not see later changes of what was hashed.
            tensors = {name: tensor.clone() for name, tensor in _read_tensors(path, item.name).items()}
        else:
            documents[file.name] = _read_document(path)
    return Checkpoint(item.name, tensors, documents, item.config)


def _read_tensors(path: Path, name: str) -> "Mapping[str, torch.Tensor]":
    if path.suffix == ".safetensors":
        return _read_safetensors(path)
    import torch

    from moseg.tasks.networks import unwrap_state

    try:
        with torch.serialization.safe_globals(STAND_INS), warnings.catch_warnings():
            # The result of an uncommon protocol is checked below.
            warnings.filterwarnings("ignore", "Detected pickle protocol", UserWarning)
            # Mapped, not read: published checkpoints hold more than the network, such as an optimiser's state.
            content = torch.load(path, weights_only=True, map_location="cpu", mmap=zipfile.is_zipfile(path))
    # A damaged or foreign file raises errors without a common class: of pickle, zip and torch, and built-in ones.
    except Exception as error:
        expected = "tensors saved by torch, and no code to be run"
        raise InputError("unreadable weights", where=path, got=_refusal(error, path), expected=expected) from error
    return unwrap_state(content, name)


def _read_safetensors(path: Path) -> "Mapping[str, torch.Tensor]":
    from safetensors import SafetensorError
    from safetensors.torch import load_file

    try:
        return load_file(path)
    except (SafetensorError, OSError, ValueError) as error:
        raise InputError("unreadable weights", where=path, got=_first_line(error), expected="safetensors") from error


def _read_document(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError("unreadable file", where=path, got=_first_line(error), expected="UTF-8 text") from error


def _refusal(error: Exception, path: Path) -> str:
    """Return what torch refused to run, else what is wrong with the file.

    Torch's own message is not shown: it advises to run the file nevertheless, or says where in torch it failed.
    """
    name = re.search(r"Unsupported (?:global: GLOBAL|class) (\S+)", str(error))
    if name is not None:
        return name[1]
    if isinstance(error, OSError):
        return error.strerror or _first_line(error)
    if isinstance(error, MemoryError) or re.search(r"allocate memory|not enough memory", str(error)):
        return "not enough memory for it"
    with open(path, "rb") as file:
        head = file.read(len(ARCHIVE))
    return "a damaged archive" if head == ARCHIVE else "a damaged file or one of another format"


def _first_line(error: Exception) -> str:
    return str(error).partition("\n")[0] or type(error).__name__


def file_state(path: Path) -> tuple[int, int, int]:
    """Return values that change if a file is written to or replaced."""
    stat = os.stat(path)
    return stat.st_ino, stat.st_size, stat.st_mtime_ns


_FORMATS = {"f8": "d", "f4": "f", "i8": "q"}
_ORDERS = ("<", ">", "=", "|")


class NumberKind:
    """Stand-in for a dtype of float64, float32 or int64."""

    def __init__(self, code: str):
        self.code = code
        self.order = "<"

    def __setstate__(self, state: tuple) -> None:
        # Version, byte order, then three items that only dtypes with parts or fields have.
        if type(state) is not tuple or len(state) < 5 or state[1] not in _ORDERS or state[2:5] != (None, None, None):
            raise ValueError("not a plain number")
        self.order = ">" if state[1] == ">" else "<"


def make_kind(code: object, *_flags: object) -> NumberKind:
    """Return the stand-in for a ``numpy.dtype``."""
    if type(code) is not str or code not in _FORMATS:
        raise ValueError("not a plain number")
    return NumberKind(code)


def make_number(kind: object, content: object) -> float | int:
    """Return a plain number, in place of ``numpy.core.multiarray.scalar``."""
    if type(kind) is not NumberKind or type(content) is not bytes:
        raise ValueError("not a plain number")
    (number,) = struct.unpack(kind.order + _FORMATS[kind.code], content)
    return number


STAND_INS = [
    (make_number, "numpy.core.multiarray.scalar"),
    (make_number, "numpy._core.multiarray.scalar"),
    (make_kind, "numpy.dtype"),
    NumberKind,
]
"""Stand-ins for what NumPy's numbers are pickled as, for `torch.serialization.safe_globals`.

A file makes plain numbers by them, and nothing else. An optimiser's learning rate is such a number if it was computed
from NumPy's integers, as DeAOT's training code does after a restart. NumPy's own constructors are not given to a file:
its dtypes can be made to hold objects, and bytes are then taken for addresses. NumPy 1 and 2 differ in names.
"""
