"""One file per frame: which file is which frame's."""

import re
from collections.abc import Sequence
from pathlib import Path

from schemas.errors import MissingInputError

_NUMBER = re.compile(r"\d+")


class FrameFiles:
    """The files of one sequence, in the order of the numbers in their names.

    Where there are as many files as frames, they are the frames in order, whatever number they begin with. Otherwise
    the last number in a file's name is its frame, counted from 0.

    Parameters
    ----------
    folders : sequence of Path
        Where the sequence may lie; the first that holds files counts.
    pattern : str
        Names of its files.
    num_frames : int
        Frames of the sequence.
    by_pairs : bool
        The method looks at a frame and its next, so the last frame may have no file; it then repeats the one before.

    Raises
    ------
    MissingInputError
        Where no folder holds files.
    """

    def __init__(self, folders: Sequence[Path], pattern: str, num_frames: int, by_pairs: bool = False):
        self.num_frames = num_frames
        for self.folder in folders:
            self.paths = sorted(self.folder.glob(pattern), key=lambda path: (frame_number(path), path.name))
            if self.paths:
                break
        else:
            expected = " or ".join(str(folder / pattern) for folder in folders)
            raise MissingInputError("no predictions of the sequence", expected=expected)
        if by_pairs and len(self.paths) == num_frames - 1:
            self.paths.append(self.paths[-1])
        self._by_number = {frame_number(path): path for path in self.paths}

    def path(self, index: int) -> Path:
        """The file of frame `index`; raises MissingInputError where there is none."""
        if len(self.paths) == self.num_frames:
            return self.paths[index]
        if index not in self._by_number:
            raise MissingInputError(
                f"no prediction of frame {index}",
                where=self.folder,
                got=f"{len(self.paths)} files for {self.num_frames} frames",
            )
        return self._by_number[index]


def frame_number(path: Path) -> int:
    """The last number in a file's name, -1 where it has none."""
    numbers = _NUMBER.findall(path.stem)
    return int(numbers[-1]) if numbers else -1
