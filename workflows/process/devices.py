"""The device on which this process runs networks; it is not part of any key.

torch is imported only if the answer depends on it, so that runs without networks never wait for it.
"""

import re
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING

from moseg.schemas.errors import InputError
from moseg.schemas.spelling import closest

if TYPE_CHECKING:
    import torch

DEVICES = "auto, cpu, cuda, cuda:N or mps"

_chosen = "auto"


def read_device(text: str) -> str:
    """Return the device that `text` names, on any machine; raise InputError if it names none."""
    if not re.fullmatch(r"auto|cpu|mps|cuda(:[0-9]+)?", text):
        close = closest(text, ("auto", "cpu", "cuda", "mps"))
        expected = DEVICES if close is None else f"{DEVICES}; did you mean {close!r}?"
        raise InputError("unknown device", where="--device", got=repr(text), expected=expected)
    return text


def parse_device(text: str) -> str:
    """Return the device that `text` names; raise InputError if it names none, or one that is not here."""
    kind, _, index = read_device(text).partition(":")
    if kind == "cuda":
        count = _num_cuda(_require_torch(text))
        if int(index or 0) >= count:
            got = f"{text}, where torch sees {count} CUDA devices"
            raise InputError("no such device", where="--device", got=got, expected="auto or cpu")
    elif kind == "mps" and not _require_torch(text).backends.mps.is_available():
        raise InputError("no such device", where="--device", got="mps, which torch lacks", expected="auto or cpu")
    return text


def set_device(text: str) -> None:
    """Have this process run its networks on the device that `text` names; raise as `parse_device`."""
    global _chosen
    _chosen = parse_device(text)


def chosen_device() -> str:
    """Return the last argument of `set_device`."""
    return _chosen


def current_device() -> "torch.device":
    """Return the device that was set: the first GPU for ``cuda``; for ``auto`` also Apple's GPU or else the CPU."""
    torch = _require_torch(_chosen)
    return torch.device((*list_accelerators(_chosen), "cpu")[0])


def list_accelerators(text: str) -> tuple[str, ...]:
    """Return the devices that share the work under ``--device text``: every visible CUDA device, or the named one.

    Returns
    -------
    tuple of str
        Such as ``cuda:0``; empty if networks run on the CPU.
    """
    if text == "cpu" or ":" in text or text == "mps":
        return () if text == "cpu" else (text,)
    try:
        import torch
    except ImportError:
        return ()
    if count := _num_cuda(torch):
        return tuple(f"cuda:{index}" for index in range(count))
    return ("mps",) if text == "auto" and torch.backends.mps.is_available() else ()


@contextmanager
def network_context(device: "torch.device") -> Iterator[None]:
    """Run the block without gradients; on CUDA in half precision, except where autocast keeps float32."""
    import torch

    with ExitStack() as stack:
        stack.enter_context(torch.inference_mode())
        if device.type == "cuda":
            # Kernels without a device use the current one.
            stack.enter_context(torch.cuda.device(device))
            # Operations in single precision must not use TF32, which has ten bits.
            torch.backends.cudnn.allow_tf32 = False
            stack.enter_context(torch.autocast("cuda", dtype=torch.float16))
        yield


def _num_cuda(torch) -> int:
    return torch.cuda.device_count() if torch.cuda.is_available() else 0


def _require_torch(text: str):
    try:
        import torch
    except ImportError as error:
        where = f"--device {text}"
        raise InputError(
            "networks need torch", where=where, got=error, expected="pip install 'moseg[models]'"
        ) from error
    return torch
