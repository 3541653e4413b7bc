"""Sets of choices under one name: which networks give the cues, and how the geometry is done."""

from collections.abc import Mapping
from typing import Any

Choices = Mapping[str, Any]
"""Values of a `PipelineConfig`, stage by stage; what is not named keeps its default."""

GEOMETRIES: Mapping[str, Choices] = {
    "default": {},
    "paper": {
        "fundamental": {
            "estimator": "eight_point_ransac",
            "num_samples": 200,
            "num_refits": 1,
            "degenerate": "discard",
            "statistic": "mean",
        },
        "affinity": {"method": "ork"},
        "clustering": {"grouping": "spectral", "fusion": "coregularised", "auto": "eigengap", "static": "group"},
    },
}
"""`paper`: Huang, Chen and Zelek, sections 3.3 to 3.5, with the flow model corrected; ``--motions gt`` gives it their
number of motions."""

PRESETS: Mapping[str, Choices] = {
    "weights-free": {},
    "paper": {
        "proposal_source": "detections",
        "detections": {"tagger": "ram", "masks": "sam-hq", "tracker": "deaot"},
        "tracks": {"method": "pips"},
        "flow": {"method": "raft"},
        "depth": {"method": "dpt-dinov2"},
    },
    "modern": {
        "proposal_source": "detections",
        "detections": {"tagger": "ram-plus", "masks": "sam2", "tracker": "sam2"},
        "grounding_dino": {"weights": "grounding-dino-base"},
        "tracks": {"method": "pips"},
        "flow": {"method": "raft"},
        "depth": {"method": "depth-anything-v2"},
    },
}
"""`paper`: the models of Huang, Chen and Zelek, sections 3.1 and 3.2; with the geometry of the same name it is their
method, which must be told the number of motions. `modern`: networks of today under licences that allow any use."""

QUALITIES: Mapping[str, Choices] = {
    "fast": {"max_side": 427, "saliency": {"working_side": 284}},
    "default": {},
    "best": {"flow": {"preset": "fine"}},
}
"""What accuracy may cost, on any preset: the size that frames are analysed at, and how finely DIS searches. Other flow
is the same in `best`."""
