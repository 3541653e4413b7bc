"""Fits of an artifact that the data did not determine: one rule for every stage.

A stage that fits models marks the determined ones in a boolean array ``valid``, and may give the reason for the others
in an array ``reason`` of the same shape.
"""

from collections.abc import Mapping
from enum import IntEnum

import numpy as np

from moseg.schemas.events import DegenerateEvent
from moseg.tasks.geometry import Degeneracy
from moseg.workflows.runlog.events import this_process

REASONS: dict[str, type[IntEnum]] = {"fundamental": Degeneracy}
"""Meaning of the codes in a stage's ``reason``."""


def degenerate_event(ref: str, stage: str, arrays: Mapping[str, np.ndarray]) -> DegenerateEvent | None:
    """Return an event about the invalid fits in an artifact's arrays, or None if there are none."""
    valid = arrays.get("valid")
    if valid is None or valid.all():
        return None
    reasons: dict[str, int] = {}
    if stage in REASONS:
        codes, counts = np.unique(arrays["reason"][~valid], return_counts=True)
        names = (REASONS[stage](code).name.lower().replace("_", "-") for code in codes.tolist())
        reasons = dict(zip(names, counts.tolist(), strict=True))
    num_invalid = int(np.count_nonzero(~valid))
    return DegenerateEvent(ref=ref, num_invalid=num_invalid, num_fits=valid.size, reasons=reasons, **this_process())
