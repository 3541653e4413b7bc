"""Errors that a user can cause or see. Each states in one line what, where, got and expected."""

import re

LONGEST_GOT = 2000
"""Characters that are shown of the value found: a damaged file may contain a name of millions."""

_CONTROL = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029]")


class MosegError(Exception):
    """Base of every error raised on purpose by this project.

    Its text is one line: line breaks become blanks, and other control characters, which a damaged file may contain, are
    written as ``\\x1b``. Of the value found only the first `LONGEST_GOT` characters are shown.

    Parameters
    ----------
    what : str
        What is wrong, in a few words.
    where : object, optional
        File, option, sequence or array in which it is wrong.
    got, expected : object, optional
        The value found, and the accepted ones.
    """

    def __init__(self, what: str, *, where: object = None, got: object = None, expected: object = None):
        parts = [what]
        if where is not None:
            parts[0] += f" in {where}"
        if got is not None:
            text = str(got)
            parts.append(f"got {text if len(text) <= LONGEST_GOT else text[: LONGEST_GOT - 1] + '…'}")
        if expected is not None:
            parts.append(f"expected {expected}")
        self.parts = (what, where, got, expected)
        super().__init__(_CONTROL.sub(_escape, "; ".join(parts)))

    def __reduce__(self):
        what, where, got, expected = self.parts
        return _rebuild, (type(self), what, _text(where), _text(got), _text(expected)), self.__dict__


def _escape(control: re.Match[str]) -> str:
    return " " if control[0] == "\n" else control[0].encode("unicode_escape").decode("ascii")


def _text(value: object) -> str | None:
    return None if value is None else str(value)


def _rebuild(kind, what, where, got, expected):
    return kind(what, where=where, got=got, expected=expected)


class InputError(MosegError, ValueError):
    """Wrong use or bad input: the command line ends with exit code 2."""


class MissingInputError(InputError, FileNotFoundError):
    """A requested file, folder or data set does not exist."""


class UnnamedParameterError(MosegError, AttributeError):
    """A task reads a parameter outside its recipe: a fault of the program, exit code 1."""


class StoreError(MosegError, OSError):
    """The artifact store failed (disk full, not writable), or the disk of an output did: a fault, exit code 1."""


class ClusterError(MosegError, RuntimeError):
    """Workers or their scheduler failed, not the computation: a fault, exit code 1."""


class StoreChoiceError(StoreError, InputError):
    """The given place is not a store and cannot become one: bad input."""


class MissingStoreError(StoreChoiceError, FileNotFoundError):
    """There is no store at this place, and none is created."""


class MissingArtifactError(StoreError, KeyError):
    """No artifact is stored under this reference."""

    __str__ = Exception.__str__


class CorruptArtifactError(StoreError):
    """An artifact's bytes differ from the digests of its manifest.

    ``ref`` is the artifact's reference, by which a run can quarantine and recompute it.
    """

    def __init__(self, what, *, where=None, got=None, expected=None, ref: str | None = None):
        super().__init__(what, where=where, got=got, expected=expected)
        self.ref = ref if ref is not None else _text(where)
