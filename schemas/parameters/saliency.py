"""Parameters of motion saliency and of the object proposals taken from it (weights-free)."""

from pydantic import Field

from schemas.frozen import Frozen


class SaliencyParams(Frozen):
    """Per-frame motion saliency: residual against a two-layer background motion."""

    working_side: int = Field(427, ge=32, description="longer side of the working grid, px")


class ProposalParams(Frozen):
    """Accumulation of saliency along the flow and its space-time components."""

    threshold: float = Field(0.6, gt=0, lt=1, description="accumulated saliency above which a pixel belongs to an object")
