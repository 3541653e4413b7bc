"""Object-specific point tracks; those by networks are in `pips` and `bootstapir`, because only they need torch."""

from moseg.tasks.tracks.assemble import Tracks
from moseg.tasks.tracks.assign import assign_tracks
from moseg.tasks.tracks.track import track_points

__all__ = ["Tracks", "assign_tracks", "track_points"]
