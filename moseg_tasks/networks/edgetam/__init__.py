"""EdgeTAM: SAM 2's image and video networks for small devices."""

from moseg.tasks.networks.edgetam.build import build_edgetam_image, build_edgetam_video

__all__ = ["build_edgetam_image", "build_edgetam_video"]
