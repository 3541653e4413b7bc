"""Public figures of weights items: what each gives, as its authors or a benchmark report it.

An item is listed only if its figure was read: at the source that is named, or in a later paper that quotes it.
"""

from collections.abc import Mapping
from typing import NamedTuple


class Figure(NamedTuple):
    """Public figure.

    Attributes
    ----------
    text : str
        Data set, measure and value.
    source : str
        Publication, benchmark or page that reports it.
    """

    text: str
    source: str


_SAM2, _DINO = "facebookresearch/sam2, README", "IDEA-Research/GroundingDINO, README"
_DEPTH_V2 = "Yang et al., NeurIPS 2024, table 3"
_RAFT, _SEA_RAFT = "torchvision, weights of RAFT", "Spring benchmark; Wang et al., ECCV 2024"

FIGURES: Mapping[str, Figure] = {
    "raft-large": Figure(
        "Sintel final: 3.07 px; Spring: 6.8 % over 1 px (authors' weights)", f"{_RAFT}; Spring benchmark"
    ),
    "raft-small": Figure("Sintel final, not trained on it: 3.28 px (large: 2.72)", _RAFT),
    "sea-raft-m": Figure("Spring: 3.7 % over 1 px; KITTI: 4.6 % outliers (RAFT: 5.1)", _SEA_RAFT),
    "sea-raft-s": Figure("Spring: 3.9 % over 1 px", _SEA_RAFT),
    "sam2.1-hiera-tiny": Figure("SA-V test: 76.5 J&F", _SAM2),
    "sam2.1-hiera-small": Figure("SA-V test: 76.6 J&F", _SAM2),
    "sam2.1-hiera-base-plus": Figure("SA-V test: 78.2 J&F", _SAM2),
    "sam2.1-hiera-large": Figure("SA-V test: 79.5 J&F", _SAM2),
    "deaot-r50-l": Figure("YouTube-VOS 2018: 86.0 J&F", "yoxu515/aot-benchmark, MODEL_ZOO"),
    "edgetam": Figure("SA-V test: 71.7 J&F; DAVIS-2017 val: 87.7", "Zhou et al., CVPR 2025"),
    "sam3": Figure(
        "by names: LVIS, 48.5 mask AP; videos of SA-Co, SA-V test: 58.0 pHOTA", "facebookresearch/sam3, README"
    ),
    "bootstapir": Figure(
        "TAP-Vid DAVIS: 62.4 average Jaccard (first query, 256x256)", "google-deepmind/tapnet, README"
    ),
    "depth-anything-v2-small": Figure("DA-2K: nearer of two points in 95.3 % of pairs", _DEPTH_V2),
    "depth-anything-v2-base": Figure("DA-2K: 97.0 %", _DEPTH_V2),
    "depth-anything-v2-large": Figure("DA-2K: 97.1 %", _DEPTH_V2),
    "grounding-dino-tiny": Figure("COCO, not trained on it: 48.4 AP", _DINO),
    "grounding-dino-base": Figure("COCO, trained on it: 56.7 AP", _DINO),
}
