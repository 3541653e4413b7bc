"""Moving objects of a section's tracks."""

from moseg.tasks.track_objects.field import PairEvidence, couple_tracks, mean_field, track_evidence
from moseg.tasks.track_objects.objects import TrackObjects, find_objects

__all__ = ["PairEvidence", "TrackObjects", "couple_tracks", "find_objects", "mean_field", "track_evidence"]
