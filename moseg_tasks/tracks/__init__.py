"""Object-specific point tracks."""

from moseg_tasks.tracks.assign import assign_tracks
from moseg_tasks.tracks.track import Tracks, track_points

__all__ = ["Tracks", "assign_tracks", "track_points"]
