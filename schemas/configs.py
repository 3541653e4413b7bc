"""The configuration of a run: the parameters of every stage, and the variants of the paper's ablation."""

from collections.abc import Sequence
from enum import StrEnum
from typing import Annotated, Literal, Self

from pydantic import Field, field_validator

from moseg.schemas.choices import ChoiceOf
from moseg.schemas.frozen import Frozen
from moseg.schemas.parameters import (
    AccumulationParams,
    AffinityParams,
    AppearanceParams,
    BlackBarParams,
    BootsTapirParams,
    CameraParams,
    CandidateParams,
    CarryingParams,
    ClipSectionParams,
    ClusteringParams,
    ComponentParams,
    ConfidenceParams,
    DeaotParams,
    DenseTrackParams,
    DepthAnything3Params,
    DepthAnythingParams,
    DepthParams,
    DetectionParams,
    DptDinov2Params,
    EdgeTamParams,
    FlowModelParams,
    FlowParams,
    ForegroundParams,
    FundamentalParams,
    GroundingDinoParams,
    GrowingParams,
    HypothesisParams,
    IdentityParams,
    InstanceParams,
    KernelParams,
    LinkingParams,
    LocalColourParams,
    MotionMemoryParams,
    MotionNetworkParams,
    MotionPromptParams,
    MotionProofParams,
    MovesNowParams,
    MovingObjectParams,
    NoiseReductionParams,
    ObjectHypothesisParams,
    ObjectPointParams,
    OwnMotionParams,
    PipsParams,
    PluginParams,
    RaftParams,
    RamParams,
    RefinementParams,
    RepetitionParams,
    RigidityParams,
    RigidSupportParams,
    SaliencyParams,
    Sam2Params,
    Sam3Params,
    SamHqParams,
    SceneCutParams,
    SceneParallaxParams,
    ScreenGraphicsParams,
    SeaRaftParams,
    SeedParams,
    SlowMotionParams,
    TrackFieldParams,
    TrackGroupParams,
    TrackMaskParams,
    TrackObjectParams,
    TrackParams,
    TrackSurfaceParams,
    TrackWindowParams,
    TrajectoryClusteringParams,
    VideoNetworkParams,
)
from moseg.schemas.parameters.comma_separated import check_models, split_commas
from moseg.schemas.units import Unit


class Variant(StrEnum):
    """Rows of the paper's ablation."""

    FUSED = "fused"
    OC_DEPTH = "oc-depth"
    OC = "oc"
    TRAJS = "trajs"
    BASE = "base"


class TrajectoryVariant(StrEnum):
    """Rows of the ablation on labelled trajectories: all point models fused, or one alone."""

    FUSED = "fused"
    TRAJS = "trajs"
    HOMOGRAPHY = "homography"
    AFFINE = "affine"


ProposalSource = Literal["auto", "saliency", "tracks", "motion-prompts", "detections", "sam3", "groundtruth", "folder"]
"""Source of the object proposals."""
MOTION_SOURCES = ("auto", "saliency", "tracks")
"""Sources of proposals whose masks are made from motion."""
MOVING_SOURCES = (*MOTION_SOURCES, "motion-prompts")
"""Sources of proposals that propose objects because they move."""
BY_CAMERA = ("auto", "motion-prompts")
"""Sources of proposals for which the camera's motion in a stretch chooses between saliency and tracks."""
SALIENCY_SOURCES = (*BY_CAMERA, "saliency")
"""Sources of proposals that may read motion saliency."""
TRACKED_SOURCES = ("detections", "motion-prompts", "sam3")
"""Sources of proposals whose objects are outlined in a section's first frame, and tracked by a network from there."""
POINT_PROMPTED = ("sam2", "edgetam")
"""Networks for masks that take points as prompts."""


class SectionParams(Frozen):
    """Parameters of the cut of a video into sections; each section has object proposals of its own."""

    length: Annotated[int, Unit.FRAMES] = Field(30, ge=1, description="l of the paper: frames of a section")
    overlap: Annotated[int, Unit.FRAMES] = Field(
        12, ge=1, description="frames that a section's proposals share with the next, for linking"
    )


class PipelineConfig(Frozen):
    """Parameters of the whole pipeline; each stage's recipe contains only those that the stage reads."""

    max_side: Annotated[int, Unit.PIXELS] = Field(
        1280, ge=16, description="frames with a longer side are reduced to this for analysis, px"
    )
    proposal_source: ProposalSource = Field(
        "auto",
        description="object proposals: auto (saliency or tracks, by the camera's motion in each stretch of the video),"
        " motion saliency, tracks (groups of dense point tracks that no rigid scene explains), motion-prompts (objects"
        " that networks outline and track, prompted by the regions of auto), detections (objects that networks name,"
        " find, outline and track), sam3 (objects that SAM 3 alone finds by name, outlines and tracks), the ground"
        " truth's objects, or a folder of masks",
    )
    fused_flow_model: Annotated[str, ChoiceOf("fused_flow_model")] = Field(
        "oc_depth",
        description="flow model that the fused variant combines; oc_depth_paper is also that of the variant oc-depth",
    )
    flow: FlowParams = FlowParams()
    depth: DepthParams = DepthParams()
    sections: SectionParams = SectionParams()
    detections: DetectionParams = DetectionParams()
    ram: RamParams = RamParams()
    grounding_dino: GroundingDinoParams = GroundingDinoParams()
    sam_hq: SamHqParams = SamHqParams()
    sam2: Sam2Params = Sam2Params()
    edgetam: EdgeTamParams = EdgeTamParams()
    sam3: Sam3Params = Sam3Params()
    motion_prompts: MotionPromptParams = MotionPromptParams()
    instances: InstanceParams = InstanceParams()
    seeds: SeedParams = SeedParams()
    deaot: DeaotParams = DeaotParams()
    pips: PipsParams = PipsParams()
    bootstapir: BootsTapirParams = BootsTapirParams()
    raft: RaftParams = RaftParams()
    sea_raft: SeaRaftParams = SeaRaftParams()
    dpt_dinov2: DptDinov2Params = DptDinov2Params()
    depth_anything_v2: DepthAnythingParams = DepthAnythingParams()
    depth_anything_3: DepthAnything3Params = DepthAnything3Params()
    saliency: SaliencyParams = SaliencyParams()
    motion_network: MotionNetworkParams = MotionNetworkParams()
    accumulation: AccumulationParams = AccumulationParams()
    motion_memory: MotionMemoryParams = MotionMemoryParams()
    own_motion: OwnMotionParams = OwnMotionParams()
    appearance: AppearanceParams = AppearanceParams()
    foreground: ForegroundParams = ForegroundParams()
    motion_proof: MotionProofParams = MotionProofParams()
    video_network: VideoNetworkParams = VideoNetworkParams()
    identity: IdentityParams = IdentityParams()
    components: ComponentParams = ComponentParams()
    dense_tracks: DenseTrackParams = DenseTrackParams()
    cameras: CameraParams = CameraParams()
    rigidity: RigidityParams = RigidityParams()
    repetitions: RepetitionParams = RepetitionParams()
    black_bars: BlackBarParams = BlackBarParams()
    screen_graphics: ScreenGraphicsParams = ScreenGraphicsParams()
    scene_cuts: SceneCutParams = SceneCutParams()
    slow_motion: SlowMotionParams = SlowMotionParams()
    scene_parallax: SceneParallaxParams = SceneParallaxParams()
    local_colours: LocalColourParams = LocalColourParams()
    refinement: RefinementParams = RefinementParams()
    track_window: TrackWindowParams = TrackWindowParams()
    track_field: TrackFieldParams = TrackFieldParams()
    track_candidates: CandidateParams = CandidateParams()
    track_groups: TrackGroupParams = TrackGroupParams()
    track_objects: TrackObjectParams = TrackObjectParams()
    object_points: ObjectPointParams = ObjectPointParams()
    track_masks: TrackMaskParams = TrackMaskParams()
    track_surfaces: TrackSurfaceParams = TrackSurfaceParams()
    moves_now: MovesNowParams = MovesNowParams()
    confidence: ConfidenceParams = ConfidenceParams()
    linking: LinkingParams = LinkingParams()
    rigid_support: RigidSupportParams = RigidSupportParams()
    tracks: TrackParams = TrackParams()
    fundamental: FundamentalParams = FundamentalParams()
    flow_model: FlowModelParams = FlowModelParams()
    object_hypotheses: ObjectHypothesisParams = ObjectHypothesisParams()
    affinity: AffinityParams = AffinityParams()
    clustering: ClusteringParams = ClusteringParams()
    moving_objects: MovingObjectParams = MovingObjectParams()
    carrying: CarryingParams = CarryingParams()
    growing: GrowingParams = GrowingParams()
    fused_point_models: tuple[Annotated[str, ChoiceOf("fused_point_models")], ...] = Field(
        ("affine", "homography", "fundamental"),
        min_length=1,
        description="point models that the fused variant combines on labelled trajectories, separated by commas",
    )
    noise_reduction: NoiseReductionParams = NoiseReductionParams()
    hypotheses: HypothesisParams = HypothesisParams()
    kernel: KernelParams = KernelParams()
    clip_sections: ClipSectionParams = ClipSectionParams()
    trajectory_clustering: TrajectoryClusteringParams = TrajectoryClusteringParams()
    plugins: PluginParams = Field(default_factory=PluginParams)

    _split_models = field_validator("fused_point_models", mode="before")(split_commas)
    _check_models = field_validator("fused_point_models")(check_models)

    def point_models(self, variant: TrajectoryVariant) -> tuple[str, ...]:
        """Return the point models of a variant on labelled trajectories."""
        return {
            TrajectoryVariant.FUSED: self.fused_point_models,
            TrajectoryVariant.TRAJS: ("fundamental",),
            TrajectoryVariant.HOMOGRAPHY: ("homography",),
            TrajectoryVariant.AFFINE: ("affine",),
        }[variant]

    def views(self, variant: Variant) -> tuple[str, ...]:
        """Return the motion models of a variant: ``trajs`` or the name of a flow model; none for ``base``."""
        is_as_printed = self.fused_flow_model == "oc_depth_paper"
        return {
            Variant.FUSED: ("trajs", self.fused_flow_model),
            Variant.OC_DEPTH: ("oc_depth_paper" if is_as_printed else "oc_depth",),
            Variant.OC: ("oc",),
            Variant.TRAJS: ("trajs",),
            Variant.BASE: (),
        }[variant]

    @property
    def named_objects(self) -> tuple[str, ...]:
        """Return what SAM 3 looks for: the tags that were given, else its concepts."""
        return self.sam3.concepts if self.detections.tags is None else self.detections.tags

    def with_seed(self, seed: int) -> Self:
        """Return the configuration with another seed of the random draws."""
        return self.model_copy(update={"hypotheses": self.hypotheses.model_copy(update={"seed": seed})})


def seeded_configs(config: PipelineConfig, seeds: Sequence[int] | None) -> dict[int | None, PipelineConfig]:
    """Return the configuration with each of the seeds, by seed; without seeds, the configuration itself by None."""
    return {seed: config.with_seed(seed) for seed in seeds} if seeds else {None: config}
