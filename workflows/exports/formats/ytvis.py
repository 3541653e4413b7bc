"""YouTube-VIS: one annotation for each object, with a mask or nothing for each frame."""

from pathlib import Path

from moseg.workflows.exports.annotation_file import write_annotations
from moseg.workflows.exports.formats.export_format import ExportFormat
from moseg.workflows.exports.ownership import OwnedFile, is_own_annotations
from moseg.workflows.exports.run_lengths import encode_mask, list_categories, list_identities
from moseg.workflows.exports.saved_segmentation import SavedSegmentation


def write_ytvis(saved: SavedSegmentation, folder: Path, dilation: int | None = None) -> Path:
    """Write ``ytvis.json``; an annotation's ``id`` is the object's identity, its lists have an entry for each frame.

    References
    ----------
    Yang, Fan, Xu, "Video Instance Segmentation", ICCV 2019.
    """
    summary = saved.summary
    categories, category_of = list_categories(summary)
    size = {"width": summary.width, "height": summary.height}
    lists = ("segmentations", "areas", "bboxes")
    tracks = {
        identity: {
            "id": identity,
            "video_id": 1,
            "category_id": category,
            "iscrowd": 0,
            **size,
            **{name: [None] * summary.num_frames for name in lists},
        }
        for identity, category in category_of.items()
    }
    for index, labels in enumerate(saved.labels()):
        for identity in list_identities(labels):
            for name, value in zip(lists, encode_mask(labels == identity), strict=True):
                tracks[identity][name][index] = value
    files = [f"{summary.name}/{name}" for name in saved.names]
    videos = [{"id": 1, **size, "length": summary.num_frames, "file_names": files}]
    target = ytvis_file(folder, summary.name, saved.names)
    return write_annotations(target, summary, videos=videos, annotations=list(tracks.values()), categories=categories)


def ytvis_file(folder: Path, sequence: str, names: tuple[str, ...]) -> OwnedFile:
    """The file that `write_ytvis` writes."""
    return OwnedFile(folder / "ytvis.json", is_own_annotations)


YTVIS = ExportFormat(
    "ytvis", "ytvis.json, objects with a mask a frame: readers of YouTube-VIS", write_ytvis, ytvis_file
)
