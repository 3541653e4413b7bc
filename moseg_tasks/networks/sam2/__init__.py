"""SAM 2.1: masks from prompts on an image, and masks tracked through a video with a memory."""

from moseg.tasks.networks.sam2.build import build_sam2_image, build_sam2_video, network_side
from moseg.tasks.networks.sam2.sessions import forget_past, start_sessions, to_joinable

__all__ = ["build_sam2_image", "build_sam2_video", "forget_past", "network_side", "start_sessions", "to_joinable"]
