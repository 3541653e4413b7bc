"""Masks as COCO's compressed run lengths, and the categories of what moves."""

import numpy as np
from pycocotools import mask as coco_mask

from moseg.workflows.exports.motion_json import SequenceSummary

UNNAMED = "moving object"


def encode_mask(mask: np.ndarray) -> tuple[dict, int, list[float]]:
    """Run lengths of a bool (y, x) mask as JSON holds them, its area in px, and its box x, y, width, height in px."""
    runs = coco_mask.encode(np.asfortranarray(mask, dtype=np.uint8))
    segmentation = {"size": [int(side) for side in runs["size"]], "counts": runs["counts"].decode("ascii")}
    return segmentation, int(coco_mask.area(runs)), [float(side) for side in coco_mask.toBbox(runs)]


def list_identities(labels: np.ndarray) -> list[int]:
    """The identities in uint16 (y, x) labels, ascending, without 0."""
    return (np.flatnonzero(np.bincount(labels.ravel())[1:]) + 1).tolist()


def list_categories(summary: SequenceSummary) -> tuple[list[dict], dict[int, int]]:
    """Categories, one for each tag, and the category of each identity; what has no tag is a moving object."""
    names = {entry.identity: entry.tag or UNNAMED for entry in summary.objects}
    ids = {name: index + 1 for index, name in enumerate(sorted({*names.values()} or {UNNAMED}))}
    categories = [{"id": number, "name": name, "supercategory": UNNAMED} for name, number in ids.items()]
    return categories, {identity: ids[name] for identity, name in names.items()}
