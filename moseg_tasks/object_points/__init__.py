"""Points of moving objects, followed by the motion of the whole object where the tracker of points lost them."""

from moseg.tasks.object_points.follow import ObjectPoints, follow_objects

__all__ = ["ObjectPoints", "follow_objects"]
