"""COCO instances: one annotation for each object in each frame."""

from pathlib import Path

from moseg.workflows.exports.annotation_file import write_annotations
from moseg.workflows.exports.formats.export_format import ExportFormat
from moseg.workflows.exports.ownership import OwnedFile, is_own_annotations
from moseg.workflows.exports.run_lengths import encode_mask, list_categories, list_identities
from moseg.workflows.exports.saved_segmentation import SavedSegmentation


def write_coco(saved: SavedSegmentation, folder: Path, dilation: int | None = None) -> Path:
    """Write ``coco.json``; an annotation's ``track_id`` is the object's identity.

    References
    ----------
    Lin et al., "Microsoft COCO: Common Objects in Context", ECCV 2014.
    """
    summary = saved.summary
    categories, category_of = list_categories(summary)
    images, annotations = [], []
    for index, (name, labels) in enumerate(zip(saved.names, saved.labels(), strict=True)):
        size = {"width": summary.width, "height": summary.height}
        images.append({"id": index + 1, "file_name": name, **size, "frame_index": index})
        for identity in list_identities(labels):
            segmentation, area, box = encode_mask(labels == identity)
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
    return write_annotations(target, summary, images=images, annotations=annotations, categories=categories)


def coco_file(folder: Path, sequence: str, names: tuple[str, ...]) -> OwnedFile:
    """The file that `write_coco` writes."""
    return OwnedFile(folder / "coco.json", is_own_annotations)


COCO = ExportFormat(
    "coco", "coco.json, instances with run lengths: pycocotools, detectron2, FiftyOne", write_coco, coco_file
)
