"""A JSON file of annotations, as COCO began them and others took them up."""

import json
from pathlib import Path

from moseg.workflows.exports.motion_json import SequenceSummary
from moseg.workflows.exports.ownership import ANNOTATIONS_INFO, OwnedFile
from moseg.workflows.exports.write_text import write_text


def write_annotations(target: OwnedFile, summary: SequenceSummary, **parts: list[dict]) -> Path:
    """Write ``info``, ``licenses`` and the parts in their order, and return the path.

    Raises
    ------
    InputError
        A file stands there that is not ours, or it cannot be written.
    """
    info = {**ANNOTATIONS_INFO, "description": f"moving objects of {summary.name}"}
    target.check()
    write_text(target.path, json.dumps({"info": info, "licenses": [], **parts}, ensure_ascii=False) + "\n")
    return target.path
