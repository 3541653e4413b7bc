"""Results of the scenes of a video, joined to results of the whole."""

from moseg.tasks.scenes.join import join_motions, join_objects

__all__ = ["join_motions", "join_objects"]
