"""Reading and writing videos with their ground truth in the layouts of the data sets that are disturbed."""

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

import cv2
import numpy as np
import scipy.io
from disturbances import Video

_MAX_TRACKS = 2**16  # numbers below 2^24 are exact in float32, with up to 255 labels


class Layout(Protocol):
    """A data set of folders.

    Attributes
    ----------
    name : what ``moseg eval --dataset`` calls it.
    disturbances : names of those that leave its ground truth a ground truth; all if empty.
    """

    name: str
    disturbances: tuple[str, ...]

    def sequences(self, root: Path) -> list[str]:
        """Return the names of the sequences in a folder."""

    def frames_of(self, root: Path, sequence: str) -> Path:
        """Return the folder of a sequence's frames."""

    def read(self, root: Path, sequence: str) -> Video:
        """Return a sequence; raises FileNotFoundError if it is not there."""

    def write(self, root: Path, sequence: str, video: Video) -> None:
        """Write a sequence."""


class Davis:
    """DAVIS-2016: the ground truth is masks."""

    name = "davis16"
    disturbances = ()
    frames, truths = Path("JPEGImages", "480p"), Path("Annotations", "480p")

    def sequences(self, root: Path) -> list[str]:
        return sorted(path.name for path in (root / self.frames).iterdir())

    def frames_of(self, root: Path, sequence: str) -> Path:
        return root / self.frames / sequence

    def read(self, root: Path, sequence: str) -> Video:
        frames = _files(self.frames_of(root, sequence), "*.jpg")
        truths = [root / self.truths / sequence / f"{path.stem}.png" for path in frames]
        return Video(
            [cv2.imread(str(path)) for path in frames], [cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) for path in truths]
        )

    def write(self, root: Path, sequence: str, video: Video) -> None:
        quality = [cv2.IMWRITE_JPEG_QUALITY, 95]
        _write_images(self.frames_of(root, sequence), video.frames, "jpg", quality)
        _write_images(root / self.truths / sequence, video.truths, "png", [])


class Kt3dMoSeg:
    """KT3DMoSeg: the ground truth is labelled points.

    In a `Video` the truth of a pixel with a point is a code of the point's track and label, float32, which goes where
    the pixel goes. Of two points at one pixel one is lost.
    """

    name = "kt3dinsmoseg"
    disturbances = (
        *("none", "mirrored", "reversed", "every-second", "640-px"),
        *("noisy", "compressed", "coded", "dark", "exposure"),
    )

    def sequences(self, root: Path) -> list[str]:
        return sorted(path.name.removesuffix("_Tracks.mat") for path in root.glob("*_Tracks.mat"))

    def frames_of(self, root: Path, sequence: str) -> Path:
        return root / sequence / "images"

    def read(self, root: Path, sequence: str) -> Video:
        frames = [cv2.imread(str(path)) for path in _files(self.frames_of(root, sequence), "*.png")]
        data = scipy.io.loadmat(root / f"{sequence}_Tracks.mat")["Data"][0, 0]
        # Positions count from 1.
        points, visible = np.rint(data["ySparse"][:2]).astype(int) - 1, data["visibleSparse"] > 0
        codes = data["GtLabel"].ravel().astype(np.float32) * _MAX_TRACKS + np.arange(1, points.shape[1] + 1)
        truths = []
        for number, frame in enumerate(frames):
            height, width = frame.shape[:2]
            x, y = points[:, :, number]
            inside = np.flatnonzero(visible[:, number] & (x >= 0) & (x < width) & (y >= 0) & (y < height))
            truth = np.zeros((height, width), np.float32)
            truth[y[inside], x[inside]] = codes[inside]
            truths.append(truth)
        return Video(frames, truths)

    def write(self, root: Path, sequence: str, video: Video) -> None:
        _write_images(self.frames_of(root, sequence), video.frames, "png", [])
        codes = np.unique(np.concatenate([truth[truth > 0] for truth in video.truths]))
        points = np.ones((3, len(codes), len(video.frames)))
        visible = np.zeros(points.shape[1:], np.uint8)
        for number, truth in enumerate(video.truths):
            y, x = np.nonzero(truth)
            track = np.searchsorted(codes, truth[y, x])
            points[0, track, number], points[1, track, number], visible[track, number] = x + 1, y + 1, 1
        labels = (codes // _MAX_TRACKS).astype(np.uint8)
        data = {"ySparse": points, "visibleSparse": visible, "GtLabel": labels[:, None]}
        scipy.io.savemat(root / f"{sequence}_Tracks.mat", {"Data": data})


def _files(folder: Path, pattern: str) -> list[Path]:
    found = sorted(folder.glob(pattern))
    if not found:
        raise FileNotFoundError(f"no frames in {folder}")
    return found


def _write_images(folder: Path, images: Sequence[np.ndarray], suffix: str, options: list[int]) -> None:
    folder.mkdir(parents=True)
    for number, image in enumerate(images):
        cv2.imwrite(str(folder / f"{number:05}.{suffix}"), image, options)


LAYOUTS: dict[str, Layout] = {layout.name: layout for layout in (Davis(), Kt3dMoSeg())}
