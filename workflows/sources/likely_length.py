"""The number of frames of a source as its header says it, for estimates."""

from moseg.workflows.sources.frames import FrameSource
from moseg.workflows.sources.video_file import VideoFile, count_packets


def likely_num_frames(frames: FrameSource) -> int:
    """Return about how many frames a source has, without decoding a video."""
    return count_packets(frames.path) if isinstance(frames, VideoFile) else frames.num_frames()
