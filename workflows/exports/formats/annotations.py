"""COCO instances and YouTube-VIS: JSON annotations with masks as compressed run lengths."""

import json
from pathlib import Path

import numpy as np
from pycocotools import mask as coco_mask

from moseg.workflows.exports.formats.export_format import ExportFormat
from moseg.workflows.exports.motion_json import SequenceSummary
from moseg.workflows.exports.ownership import ANNOTATIONS_INFO, OwnedFile, is_own_annotations
from moseg.workflows.exports.saved_segmentation import SavedSegmentation, list_identities
from moseg.workflows.exports.write_text import write_text

UNNAMED = "moving object"


def write_coco(saved: SavedSegmentation, folder: Path, dilation: int | None = None) -> Path:
    """Write ``coco.json``, one annotation for each object in each frame; its ``track_id`` is the object's identity.

    References
    ----------
    Lin et al., "Microsoft COCO: Common Objects in Context", ECCV 2014.
    """
    summary = saved.summary
    categories, category_of = _list_categories(summary)
    images, annotations = [], []
    for index, (name, labels) in enumerate(zip(saved.names, saved.labels(), strict=True)):
        size = {"width": summary.width, "height": summary.height}
        images.append({"id": index + 1, "file_name": name, **size, "frame_index": index})
        for identity in list_identities(labels):
            segmentation, area, box = _encode_mask(labels == identity)
            annotations.append(
                {
                    "id": len(annotations) + 1,
                    "image_id": index + 1,
                    "category_id": category_of[identity],
                    "segmentation": segmentation,
                    "area": area,
                    "bbox": box,
                    "iscrowd": 0,
                    "track_id": identity,
                }
            )
    target = coco_file(folder, summary.name, saved.names)
    return _write_annotations(target, summary, images=images, annotations=annotations, categories=categories)


def coco_file(folder: Path, sequence: str, names: tuple[str, ...]) -> OwnedFile:
    """Return the file that `write_coco` writes."""
    return OwnedFile(folder / "coco.json", is_own_annotations)


def write_ytvis(saved: SavedSegmentation, folder: Path, dilation: int | None = None) -> Path:
    """Write ``ytvis.json``, one annotation for each object; its ``id`` is the identity, lists have an entry a frame.

    References
    ----------
    Yang, Fan, Xu, "Video Instance Segmentation", ICCV 2019.
    """
    summary = saved.summary
    categories, category_of = _list_categories(summary)
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
            for name, value in zip(lists, _encode_mask(labels == identity), strict=True):
                tracks[identity][name][index] = value
    files = [f"{summary.name}/{name}" for name in saved.names]
    videos = [{"id": 1, **size, "length": summary.num_frames, "file_names": files}]
    target = ytvis_file(folder, summary.name, saved.names)
    return _write_annotations(target, summary, videos=videos, annotations=list(tracks.values()), categories=categories)


def ytvis_file(folder: Path, sequence: str, names: tuple[str, ...]) -> OwnedFile:
    """Return the file that `write_ytvis` writes."""
    return OwnedFile(folder / "ytvis.json", is_own_annotations)


def _write_annotations(target: OwnedFile, summary: SequenceSummary, **parts: list[dict]) -> Path:
    """Write ``info``, ``licenses`` and the parts in their order, unless the file exists and is not moseg's own."""
    info = {**ANNOTATIONS_INFO, "description": f"moving objects of {summary.name}"}
    target.check()
    write_text(target.path, json.dumps({"info": info, "licenses": [], **parts}, ensure_ascii=False) + "\n")
    return target.path


def _encode_mask(mask: np.ndarray) -> tuple[dict, int, list[float]]:
    """Return run lengths of a bool (y, x) mask as JSON has them, its area, px, and its box x, y, width, height, px."""
    runs = coco_mask.encode(np.asfortranarray(mask, dtype=np.uint8))
    segmentation = {"size": [int(side) for side in runs["size"]], "counts": runs["counts"].decode("ascii")}
    return segmentation, int(coco_mask.area(runs)), [float(side) for side in coco_mask.toBbox(runs)]


def _list_categories(summary: SequenceSummary) -> tuple[list[dict], dict[int, int]]:
    """Return one category for each name, and the category of each identity; objects without a name are `UNNAMED`."""
    names = {entry.identity: entry.called or UNNAMED for entry in summary.objects}
    ids = {name: index + 1 for index, name in enumerate(sorted({*names.values()} or {UNNAMED}))}
    categories = [{"id": number, "name": name, "supercategory": UNNAMED} for name, number in ids.items()]
    return categories, {identity: ids[name] for identity, name in names.items()}


COCO = ExportFormat(
    "coco", "coco.json, instances with run lengths: pycocotools, detectron2, FiftyOne", write_coco, coco_file
)
YTVIS = ExportFormat(
    "ytvis", "ytvis.json, objects with a mask a frame: readers of YouTube-VIS", write_ytvis, ytvis_file
)
