"""Object-specific point tracks; those by PIPs in `pips`, so that the others do without its library."""

from moseg_tasks.tracks.assemble import Tracks
from moseg_tasks.tracks.assign import assign_tracks
from moseg_tasks.tracks.track import track_points

__all__ = ["Tracks", "assign_tracks", "track_points"]
