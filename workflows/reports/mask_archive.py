"""Masks of a sequence as a ZIP archive that lies in a report: a reader downloads it, and the page draws from it."""

import io
import zipfile

import numpy as np

from moseg.workflows.exports.outputs import mask_name
from moseg.workflows.exports.write_masks import encode_mask
from moseg.workflows.reports.content import MaskArchive

EPOCH = (1980, 1, 1, 0, 0, 0)
"""Time of every file: the earliest that the format has, so that a page does not depend on when it was made."""
LOCAL_HEADER_BYTES = 30
"""Of a file in an archive, before its name (APPNOTE.TXT 4.3.7)."""


class MaskArchiver:
    """An archive of PNG files, filled one frame at a time; PNG files are compressed already, and are only stored."""

    def __init__(self):
        self._stream = io.BytesIO()
        self._archive = zipfile.ZipFile(self._stream, "w", zipfile.ZIP_STORED)
        self._places: list[tuple[int, int, int]] = []

    def add(self, frame: int, labels: np.ndarray) -> None:
        """Add a frame's labels, uint16 (y, x), as the file that `moseg segment` would write."""
        info = zipfile.ZipInfo(mask_name(frame), EPOCH)
        data = encode_mask(labels)
        self._archive.writestr(info, data)
        start = info.header_offset + LOCAL_HEADER_BYTES + len(info.filename) + len(info.extra)
        self._places.append((frame, start, len(data)))

    def finish(self) -> MaskArchive:
        """Return the whole archive."""
        self._archive.close()
        return MaskArchive(self._stream.getvalue(), tuple(self._places))
