"""The number of frames of a source as its header says it, for estimates."""

from moseg.workflows.sources.frames import FrameSource
from moseg.workflows.sources.video_file import VideoFile, count_packets


def likely_num_frames(frames: FrameSource) -> int:
    """Return about how many frames a source has, without decoding a video."""
    is_whole_video = isinstance(frames, VideoFile) and frames.numbers is None
    return count_packets(frames.path) if is_whole_video else frames.num_frames()
