"""A table of the objects of every frame: where each is, how large, and whether it moves now."""

from pathlib import Path

import numpy as np

from moseg.workflows.exports.formats.export_format import ExportFormat
from moseg.workflows.exports.motion_json import FrameFigures
from moseg.workflows.exports.owned_folder import OwnedFolder
from moseg.workflows.exports.saved_segmentation import SavedSegmentation, list_identities
from moseg.workflows.exports.write_text import write_text

COLUMNS = "frame,file,identity,motion,left,top,right,bottom,pixels,moves_now,sure,complete,name"


def write_csv(saved: SavedSegmentation, folder: Path, dilation: int | None = None) -> Path:
    """Write ``objects/objects.csv``: a line for each object and frame.

    The box holds its outermost pixels; `moves_now` is 1 if it moves, 0 if it rests; `sure` and `complete` are the
    expected precision and recall of its mask; `name` is the user's name of it, else that of a network. They are empty
    if they are not known.
    """
    of_identity = {entry.identity: entry for entry in saved.summary.objects}
    confidences = {identity: _confidences(entry.per_frame) for identity, entry in of_identity.items()}
    lines = [COLUMNS]
    for frame, (name, labels) in enumerate(zip(saved.names, saved.labels(), strict=True)):
        for identity in list_identities(labels):
            entry = of_identity[identity]
            y, x = np.nonzero(labels == identity)
            box = f"{x.min()},{y.min()},{x.max()},{y.max()},{len(x)}"
            moves = "" if entry.moving_frames is None else int(entry.moves_now(frame))
            confidence = confidences[identity].get(frame, ",")
            what = f"{frame},{_quoted(name)},{identity},{entry.motion}"
            lines.append(f"{what},{box},{moves},{confidence},{_quoted(entry.called or '')}")
    with csv_folder(folder, saved.summary.name, saved.names) as target:
        write_text(target.folder / "objects.csv", "\n".join(lines) + "\n")
    return target.folder


def _confidences(figures: FrameFigures | None) -> dict[int, str]:
    """Return the fields `sure` and `complete` by frame; what is not known is empty."""
    if figures is None:
        return {}
    unknown = (None,) * len(figures.frame)
    columns = (figures.sure or unknown, figures.complete or unknown)
    return {
        frame: ",".join("" if value is None else str(value) for value in values)
        for frame, *values in zip(figures.frame, *columns, strict=True)
    }


def csv_folder(folder: Path, sequence: str, names: tuple[str, ...]) -> OwnedFolder:
    """Return the folder that `write_csv` writes, and the name in it."""
    return OwnedFolder(folder / "objects", ("objects.csv",))


def _quoted(name: str) -> str:
    """Return a field of RFC 4180: quoted, with doubled quotes, if it holds a comma, a quote or a line break."""
    return '"' + name.replace('"', '""') + '"' if any(character in name for character in ',"\r\n') else name


CSV = ExportFormat("csv", "objects/objects.csv, box, area and moves now by object and frame", write_csv, csv_folder)
