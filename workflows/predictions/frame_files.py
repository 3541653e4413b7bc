"""One file per frame: which file is which frame's."""

from collections.abc import Sequence
from pathlib import Path

from moseg.schemas.errors import MissingInputError
from moseg.workflows.predictions.frame_list import FrameList
from moseg.workflows.sources.files import natural_key
from moseg.workflows.sources.frame_matching import match_names


class FrameFiles:
    """The files of one sequence, each matched to its frame by `match_names`.

    Parameters
    ----------
    folders : sequence of Path
        Where the sequence may lie; the first that holds files counts. Hidden files are left out.
    pattern : str
        Names of its files. What stands for the asterisk is compared with the frames' names.
    frames : FrameList
        Frames of the sequence.
    by_pairs : bool
        The method looks at a frame and its next, so the last frame may have no file; it then repeats the one before.

    Attributes
    ----------
    matching : Matching
        How the files were matched.
    repeats_last : bool
        The last frame has no file, and that of the one before counts.

    Raises
    ------
    MissingInputError
        Where no folder holds files.
    InputError
        Where the frame of a file cannot be told from its name.
    """

    def __init__(self, folders: Sequence[Path], pattern: str, frames: FrameList, by_pairs: bool = False):
        self._frames = frames
        for self.folder in folders:
            found = (path for path in self.folder.glob(pattern) if not path.name.startswith("."))
            paths = sorted(found, key=lambda path: natural_key(path.name))
            if paths:
                break
        else:
            expected = " or ".join(str(folder / pattern) for folder in folders)
            raise MissingInputError("no predictions of the sequence", expected=expected)
        before, after = map(len, pattern.split("*"))
        names = [path.name[before : len(path.name) - after] for path in paths]
        self.matching, indices = match_names(names, frames.stems, frames.num_frames, self.folder, by_pairs)
        self._paths = dict(zip(indices, paths, strict=True))
        last = frames.num_frames - 1
        self.repeats_last = by_pairs and sorted(self._paths) == list(range(last))
        if self.repeats_last:
            self._paths[last] = self._paths[last - 1]

    def path(self, index: int) -> Path:
        """The file of frame `index`; raises MissingInputError where there is none."""
        if index not in self._paths:
            raise MissingInputError(
                f"no prediction of frame {self._frames.name(index)}",
                where=self.folder,
                got=f"{len(self._paths)} files for {self._frames.num_frames} frames",
                expected="one for every frame with ground truth",
            )
        return self._paths[index]
