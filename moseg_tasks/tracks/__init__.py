"""Object-specific point tracks; those by PIPs in `pips`, so that the others do without its library."""

from moseg.tasks.tracks.assemble import Tracks
from moseg.tasks.tracks.assign import assign_tracks
from moseg.tasks.tracks.track import track_points

__all__ = ["Tracks", "assign_tracks", "track_points"]
