"""Dense point tracks of the whole frame, of what moves and what does not alike."""

from moseg.tasks.dense_tracks.track import DenseTracks, join_runs, track_densely

__all__ = ["DenseTracks", "join_runs", "track_densely"]
