"""Named sets of choices: the networks that compute the cues, and the methods of the geometry."""

from collections.abc import Mapping
from typing import Any

Choices = Mapping[str, Any]
"""Values of a `PipelineConfig` by stage; other parameters keep their defaults."""

GEOMETRIES: Mapping[str, Choices] = {
    "default": {},
    "paper": {
        "fundamental": {
            "estimator": "eight_point_ransac",
            "step": 1,
            "num_samples": 200,
            "num_refits": 1,
            "degenerate": "discard",
            "statistic": "mean",
        },
        "flow_model": {"step": 1},
        "affinity": {"method": "ork"},
        "clustering": {"grouping": "spectral", "fusion": "coregularised", "auto": "eigengap", "static": "group"},
    },
}
"""`paper`: Huang, Chen and Zelek, sections 3.3 to 3.5, with the flow model corrected; with ``--motions gt``, also their
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
        "tracks": {"method": "bootstapir"},
        "flow": {"method": "sea-raft"},
        "depth": {"method": "depth-anything-3"},
    },
}
"""`paper`: the models of Huang, Chen and Zelek, sections 3.1 and 3.2; with the geometry of the same name it is their
method, which needs the number of motions as input. `modern`: current networks under licences that allow any use."""

SOURCE_DEFAULTS: Mapping[str, Choices] = {
    "motion-prompts": {"detections": {"masks": "sam2", "tracker": "sam2"}},
    "sam3": {"detections": {"tracker": "sam3"}},
}
"""Values that go with a source of proposals which the user chooses: they override the preset's, not the user's own."""

LIGHT: Mapping[str, Choices] = {
    "modern": {
        "detections": {"tracker": "deaot"},
        "grounding_dino": {"weights": "grounding-dino-tiny", "input_scale": 0.6},
        "sam2": {"weights": "sam2.1-hiera-tiny"},
        "deaot": {"max_side": 481},
        "bootstapir": {"side": 256},
        "sea_raft": {"weights": "sea-raft-s", "max_side": 480},
        "depth_anything_3": {"weights": "depth-anything-3-small"},
    },
}
"""Changes of presets for a laptop (`--light`): smaller networks and smaller inputs, any use allowed."""

QUALITIES: Mapping[str, Choices] = {
    "fast": {
        "max_side": 384,
        "flow": {"preset": "lighter", "search_side": 192, "coarse_side": 0},
        "saliency": {"working_side": 192},
        "motion_network": {"step": 4},
        "scene_parallax": {"num_pairs": 4, "min_pairs": 3, "num_corners": 400},
        "rigid_support": {"step": 16},
        "tracks": {"points_per_object": 40, "background_points": 80, "window": 11, "pyramid_levels": 3},
        "fundamental": {"step": 6},
        "flow_model": {"step": 8},
    },
    "default": {},
    "best": {"flow": {"preset": "fine"}, "saliency": {"working_side": 640}, "motion_network": {"step": 1}},
}
"""Trade-offs of accuracy and time for any preset: the size at which frames are analysed, the search of DIS, the working
grid, at which frames the motion network looks, and how many points and pairs are read. `best` does not change other
flow, and its grid and network only proposals of saliency."""
