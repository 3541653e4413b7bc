"""Moving objects of a window's tracks: evidence, candidates, their motion groups, and the decision."""

from moseg.tasks.track_objects.candidates import find_candidates
from moseg.tasks.track_objects.field import PairEvidence, couple_tracks, mean_field, track_evidence
from moseg.tasks.track_objects.groups import TrackGroups, group_tracks
from moseg.tasks.track_objects.objects import TrackObjects, judge_objects
from moseg.tasks.track_objects.own_vehicle import without_own_vehicle
from moseg.tasks.track_objects.regroup import RegroupedTracks, moving_group, regroup_candidates
from moseg.tasks.track_objects.static_candidates import static_candidates
from moseg.tasks.track_objects.surfaces import find_surfaces

__all__ = [
    "PairEvidence",
    "RegroupedTracks",
    "TrackGroups",
    "TrackObjects",
    "couple_tracks",
    "find_candidates",
    "find_surfaces",
    "group_tracks",
    "judge_objects",
    "mean_field",
    "moving_group",
    "regroup_candidates",
    "static_candidates",
    "track_evidence",
    "without_own_vehicle",
]
