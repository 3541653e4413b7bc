"""The configuration of a run: the parameters of every stage, and the variants of the paper's ablation."""

from enum import StrEnum
from typing import Literal

from pydantic import Field

from schemas.frozen import Frozen
from schemas.parameters import (
    AccumulationParams,
    AffinityParams,
    AppearanceParams,
    ClusteringParams,
    ComponentParams,
    DeaotParams,
    DepthAnythingParams,
    DepthParams,
    DetectionParams,
    DptDinov2Params,
    FlowModelName,
    FlowModelParams,
    FlowParams,
    ForegroundParams,
    FundamentalParams,
    GroundingDinoParams,
    IdentityParams,
    InstanceParams,
    LinkingParams,
    OwnMotionParams,
    PipsParams,
    RaftParams,
    RamParams,
    RefinementParams,
    SaliencyParams,
    Sam2Params,
    SamHqParams,
    SeedParams,
    TrackParams,
)


class Variant(StrEnum):
    """Rows of the paper's ablation."""

    FUSED = "fused"
    OC_DEPTH = "oc-depth"
    OC = "oc"
    TRAJS = "trajs"
    BASE = "base"


class SectionParams(Frozen):
    """How a video is cut into sections; objects are proposed anew in each."""

    length: int = Field(30, ge=1, description="l of the paper: frames of a section")
    overlap: int = Field(12, ge=1, description="frames that a section's proposals share with the next, for linking")


class PipelineConfig(Frozen):
    """Every parameter of the pipeline; each stage's recipe takes only its own."""

    max_side: int = Field(1280, ge=16, description="frames with a longer side are reduced to this for analysis, px")
    proposal_source: Literal["saliency", "detections", "groundtruth", "folder"] = Field(
        "saliency",
        description="object proposals: motion saliency, detections (objects that networks name, find, outline and"
        " track), the ground truth's objects, or a folder of masks",
    )
    fused_flow_model: FlowModelName = Field("oc_depth", description="flow model that the fused variant combines")
    flow: FlowParams = FlowParams()
    depth: DepthParams = DepthParams()
    sections: SectionParams = SectionParams()
    detections: DetectionParams = DetectionParams()
    ram: RamParams = RamParams()
    grounding_dino: GroundingDinoParams = GroundingDinoParams()
    sam_hq: SamHqParams = SamHqParams()
    sam2: Sam2Params = Sam2Params()
    instances: InstanceParams = InstanceParams()
    seeds: SeedParams = SeedParams()
    deaot: DeaotParams = DeaotParams()
    pips: PipsParams = PipsParams()
    raft: RaftParams = RaftParams()
    dpt_dinov2: DptDinov2Params = DptDinov2Params()
    depth_anything_v2: DepthAnythingParams = DepthAnythingParams()
    saliency: SaliencyParams = SaliencyParams()
    accumulation: AccumulationParams = AccumulationParams()
    own_motion: OwnMotionParams = OwnMotionParams()
    appearance: AppearanceParams = AppearanceParams()
    foreground: ForegroundParams = ForegroundParams()
    identity: IdentityParams = IdentityParams()
    components: ComponentParams = ComponentParams()
    refinement: RefinementParams = RefinementParams()
    linking: LinkingParams = LinkingParams()
    tracks: TrackParams = TrackParams()
    fundamental: FundamentalParams = FundamentalParams()
    flow_model: FlowModelParams = FlowModelParams()
    affinity: AffinityParams = AffinityParams()
    clustering: ClusteringParams = ClusteringParams()

    def views(self, variant: Variant) -> tuple[str, ...]:
        """Motion models of a variant: ``trajs`` or the name of a flow model; none for ``base``."""
        return {
            Variant.FUSED: ("trajs", self.fused_flow_model),
            Variant.OC_DEPTH: ("oc_depth",),
            Variant.OC: ("oc",),
            Variant.TRAJS: ("trajs",),
            Variant.BASE: (),
        }[variant]
