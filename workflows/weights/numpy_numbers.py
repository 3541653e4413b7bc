"""Stand-ins for what NumPy's numbers are pickled as: a file makes plain numbers by them, and nothing else.

An optimiser's learning rate is such a number where it was computed from NumPy's integers, as DeAOT's training code does
after a restart. NumPy's own constructors are not handed to a file: its dtypes can be told to hold objects, and bytes
are then taken for addresses.
"""

import struct

FORMATS = {"f8": "d", "f4": "f", "i8": "q"}
ORDERS = ("<", ">", "=", "|")


class NumberKind:
    """Stands for a dtype of float64, float32 or int64."""

    def __init__(self, code: str):
        self.code = code
        self.order = "<"

    def __setstate__(self, state: tuple) -> None:
        # Version, byte order, then what only dtypes with parts or fields have.
        if type(state) is not tuple or len(state) < 5 or state[1] not in ORDERS or state[2:5] != (None, None, None):
            raise ValueError("not a plain number")
        self.order = ">" if state[1] == ">" else "<"


def make_kind(code: object, *_flags: object) -> NumberKind:
    """Stands for ``numpy.dtype``."""
    if type(code) is not str or code not in FORMATS:
        raise ValueError("not a plain number")
    return NumberKind(code)


def make_number(kind: object, content: object) -> float | int:
    """Stands for ``numpy.core.multiarray.scalar``."""
    if type(kind) is not NumberKind or type(content) is not bytes:
        raise ValueError("not a plain number")
    (number,) = struct.unpack(kind.order + FORMATS[kind.code], content)
    return number


STAND_INS = [
    (make_number, "numpy.core.multiarray.scalar"),
    (make_number, "numpy._core.multiarray.scalar"),
    (make_kind, "numpy.dtype"),
    NumberKind,
]
"""For `torch.serialization.safe_globals`: NumPy 1 and 2 name other places."""
