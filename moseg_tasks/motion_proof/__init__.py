"""Photometric proof of motion: the observed flow explains a pixel's colour, and the background's motion does not."""

from moseg.tasks.motion_proof.average import average_along_flow
from moseg.tasks.motion_proof.proof import prove_motion

__all__ = ["average_along_flow", "prove_motion"]
