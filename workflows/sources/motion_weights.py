"""The file of a motion network: the one that comes with this program, or one that a user trained."""

from contextlib import nullcontext
from dataclasses import dataclass
from importlib import resources

import numpy as np

from moseg.schemas.digests import digest_json
from moseg.schemas.errors import InputError
from moseg.workflows.sources.files import digest_file, read_bytes

PACKAGE, FILE = "moseg.workflows.weights", "motion_network.onnx"
DECODING_VERSION = 1
"""Raised when `read` starts to return other values for the same bytes."""


@dataclass(frozen=True)
class MotionWeights:
    """An ONNX file.

    Attributes
    ----------
    path : str
        Empty for the network that comes with this program.
    """

    path: str

    def fingerprint(self) -> str:
        """Return the digest of the file's bytes."""
        with self._file() as path:
            return digest_json("source", ["motion_weights", DECODING_VERSION, digest_file(str(path))])

    def read(self) -> np.ndarray:
        """Return the bytes uint8 (byte,); raises InputError if it is not a motion network."""
        from moseg.tasks.motion_network import read_network

        with self._file() as path:
            content = read_bytes(str(path))
        try:
            read_network(content)
        except InputError as error:
            what, _, got, expected = error.parts
            raise InputError(what, where=self.path or FILE, got=got, expected=expected) from error
        return np.frombuffer(content, np.uint8)

    def _file(self):
        """Return a context manager of the file's path."""
        return nullcontext(self.path) if self.path else resources.as_file(resources.files(PACKAGE) / FILE)
