"""SAM 2.1: masks from prompts on an image, and masks carried through a video by a memory."""

from moseg.tasks.networks.sam2.image import build_sam2_image
from moseg.tasks.networks.sam2.sessions import forget_past, start_sessions
from moseg.tasks.networks.sam2.side import network_side
from moseg.tasks.networks.sam2.video import build_sam2_video

__all__ = ["build_sam2_image", "build_sam2_video", "forget_past", "network_side", "start_sessions"]
