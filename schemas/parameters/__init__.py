"""Parameters of every stage, one file a stage."""

from schemas.parameters.accumulation import AccumulationParams
from schemas.parameters.affinity import AffinityParams, HypothesisAffinityParams
from schemas.parameters.appearance import AppearanceParams
from schemas.parameters.clustering import ClusteringParams, MotionCountParams
from schemas.parameters.components import ComponentParams
from schemas.parameters.deaot import DeaotParams
from schemas.parameters.depth import DepthParams
from schemas.parameters.depth_anything import DepthAnythingParams
from schemas.parameters.detections import DetectionParams
from schemas.parameters.dpt_dinov2 import DptDinov2Params
from schemas.parameters.flow import FlowParams
from schemas.parameters.flow_models import FlowModelName, FlowModelParams
from schemas.parameters.foreground import ForegroundParams
from schemas.parameters.fundamental import FundamentalParams
from schemas.parameters.grounding_dino import GroundingDinoParams
from schemas.parameters.identity import IdentityParams
from schemas.parameters.instances import InstanceParams, SeedParams
from schemas.parameters.linking import LinkingParams
from schemas.parameters.object_hypotheses import ObjectHypothesisParams
from schemas.parameters.own_motion import OwnMotionParams
from schemas.parameters.pips import PipsParams
from schemas.parameters.raft import RaftParams
from schemas.parameters.ram import RamParams
from schemas.parameters.refinement import RefinementParams
from schemas.parameters.saliency import SaliencyParams
from schemas.parameters.sam2 import Sam2Params
from schemas.parameters.sam_hq import SamHqParams
from schemas.parameters.tracks import TrackParams
from schemas.parameters.trajectories import (
    EnergyParams,
    HypothesisParams,
    KernelParams,
    PieceParams,
    SeparationParams,
    TrajectoryClusteringParams,
)

__all__ = [
    "AccumulationParams",
    "AffinityParams",
    "AppearanceParams",
    "ClusteringParams",
    "ComponentParams",
    "DeaotParams",
    "DepthAnythingParams",
    "DepthParams",
    "DetectionParams",
    "DptDinov2Params",
    "EnergyParams",
    "FlowModelName",
    "FlowModelParams",
    "FlowParams",
    "ForegroundParams",
    "FundamentalParams",
    "GroundingDinoParams",
    "HypothesisAffinityParams",
    "HypothesisParams",
    "IdentityParams",
    "InstanceParams",
    "KernelParams",
    "LinkingParams",
    "MotionCountParams",
    "ObjectHypothesisParams",
    "OwnMotionParams",
    "PieceParams",
    "PipsParams",
    "RaftParams",
    "RamParams",
    "RefinementParams",
    "SaliencyParams",
    "Sam2Params",
    "SamHqParams",
    "SeedParams",
    "SeparationParams",
    "TrackParams",
    "TrajectoryClusteringParams",
]
