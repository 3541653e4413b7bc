"""Labels of all frames in one archive of arrays."""

import zipfile
from pathlib import Path

import numpy as np

from moseg.workflows.exports.formats.export_format import ExportFormat
from moseg.workflows.exports.ownership import MARK, OwnedFile, is_own_archive
from moseg.workflows.exports.saved_segmentation import SavedSegmentation
from moseg.workflows.process.atomic_write import atomic_path, blame_output


def write_npz(saved: SavedSegmentation, folder: Path, dilation: int | None = None) -> Path:
    """Write ``<sequence>.npz``, one frame in memory at a time.

    It holds ``labels`` uint16 (frame, y, x), ``identities`` and ``motions`` uint16 (object,), ``tags`` str (object,),
    which are the names of the objects, ``names`` str (frame,) and ``fps`` float64 (); no Python objects, so that it
    loads without pickle.
    """
    summary = saved.summary
    arrays = {
        "identities": np.array([entry.identity for entry in summary.objects], dtype=np.uint16),
        "motions": np.array([entry.motion for entry in summary.objects], dtype=np.uint16),
        "tags": np.array([entry.called or "" for entry in summary.objects], dtype=np.str_),
        "names": np.array(saved.names, dtype=np.str_),
        "fps": np.array(summary.fps, dtype=np.float64),
    }
    shape = (summary.num_frames, summary.height, summary.width)
    header = {"descr": "<u2", "fortran_order": False, "shape": shape}
    target = npz_file(folder, summary.name, saved.names)
    target.check()
    path = target.path
    with atomic_path(path) as temporary, blame_output(path), zipfile.ZipFile(temporary, "w") as archive:
        archive.comment = MARK.encode()
        with archive.open(_member("labels"), "w", force_zip64=True) as file:
            np.lib.format.write_array_header_1_0(file, header)
            for labels in saved.labels():
                file.write(labels.astype("<u2").tobytes())
        for name, array in arrays.items():
            with archive.open(_member(name), "w") as file:
                np.lib.format.write_array(file, array, allow_pickle=False)
    return path


def npz_file(folder: Path, sequence: str, names: tuple[str, ...]) -> OwnedFile:
    """Return the file that `write_npz` writes."""
    return OwnedFile(folder / f"{sequence}.npz", is_own_archive)


def _member(name: str) -> zipfile.ZipInfo:
    """Return a member without a time, so that the same labels give the same bytes."""
    member = zipfile.ZipInfo(f"{name}.npy")
    member.compress_type = zipfile.ZIP_DEFLATED
    return member


NPZ = ExportFormat("npz", "<sequence>.npz, labels (frame, y, x): NumPy, moseg score", write_npz, npz_file)
