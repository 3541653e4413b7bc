"""SAM-HQ: masks of high quality from boxes."""

from moseg.tasks.networks.sam_hq.build import build_sam_hq
from moseg.tasks.networks.sam_hq.masks import ImageFeatures, decode_boxes, encode_image

__all__ = ["ImageFeatures", "build_sam_hq", "decode_boxes", "encode_image"]
