"""Support of objects, wherever they come from, for being part of the rigid scene that the dense tracks see.

`object_evidence` gathers what the tracks in an object's masks say, `support` decides by it.
"""

from moseg.tasks.rigid_support.object_evidence import ObjectEvidence, measure_objects
from moseg.tasks.rigid_support.support import combine_sections, support_of_evidence

__all__ = ["ObjectEvidence", "combine_sections", "measure_objects", "support_of_evidence"]
