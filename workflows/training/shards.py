"""Shards: the samples of a hundred scenes, each kind of array in a file of its own."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from moseg.workflows.process.atomic_write import atomic_path, blame_output

SAMPLES = 100
"""Samples of a shard; the last one has the rest."""
DRAWING_VERSION = 4
"""Raised when the same seed gives other samples; shards of another version are not read."""
_ARRAYS = ("channels", "label", "counts")


class Shard(NamedTuple):
    """The samples of a number of scenes of one size.

    Attributes
    ----------
    folder : Path
    seed, index : int
        Of the shard; its samples have the numbers from ``index * SAMPLES``.
    num_samples : int
    num_textures : int
        Painted from `seed`.
    """

    folder: Path
    seed: int
    index: int
    num_samples: int
    num_textures: int

    def is_complete(self) -> bool:
        """Return whether the files are there, readable and as long as they should be."""
        try:
            return all(len(array) == self.num_samples for array in self.read())
        except (OSError, ValueError):
            return False

    def read(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return channels float16 (sample, channel, y, x), label uint8 and counts bool (sample, y, x), on the disk."""
        return tuple(np.lib.format.open_memmap(self._path(name), mode="r") for name in _ARRAYS)

    def write(self, *arrays: np.ndarray) -> None:
        """Write the arrays of `read`; raises InputError if that fails."""
        for name, array in zip(_ARRAYS, arrays, strict=True):
            path = self._path(name)
            with atomic_path(path) as temporary, blame_output(path), open(temporary, "wb") as file:
                np.save(file, array, allow_pickle=False)

    def _path(self, name: str) -> Path:
        drawn = f"v{DRAWING_VERSION}-seed{self.seed}-textures{self.num_textures}"
        return self.folder / drawn / f"{self.index:04d}-{name}.npy"


def plan_shards(folder: Path, seed: int, first: int, num_samples: int, num_textures: int) -> tuple[Shard, ...]:
    """Return the shards of a number of samples, numbered from `first`."""
    sizes = [min(SAMPLES, num_samples - start) for start in range(0, num_samples, SAMPLES)]
    return tuple(Shard(folder, seed, first + index, size, num_textures) for index, size in enumerate(sizes))
