"""Grounding DINO: boxes of the objects that a text names."""

from moseg.tasks.networks.grounding_dino.build import GroundingDino, build_grounding_dino
from moseg.tasks.networks.grounding_dino.prompts import Prompt, compose_prompts

__all__ = ["GroundingDino", "Prompt", "build_grounding_dino", "compose_prompts"]
