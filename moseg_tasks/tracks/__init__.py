"""Object-specific point tracks."""

from moseg_tasks.tracks.assign_tracks import assign_tracks
from moseg_tasks.tracks.track_points import Tracks, track_points

__all__ = ["Tracks", "assign_tracks", "track_points"]
