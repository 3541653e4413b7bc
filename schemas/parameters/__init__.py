"""Parameters of all stages, one file per stage."""

from moseg.schemas.parameters.accumulation import AccumulationParams
from moseg.schemas.parameters.affinity import AffinityParams, HypothesisAffinityParams
from moseg.schemas.parameters.appearance import AppearanceParams
from moseg.schemas.parameters.black_bars import BlackBarParams
from moseg.schemas.parameters.bootstapir import BootsTapirParams
from moseg.schemas.parameters.cameras import CameraParams
from moseg.schemas.parameters.carrying import CarryingParams
from moseg.schemas.parameters.clustering import ClusteringParams, MotionCountParams
from moseg.schemas.parameters.components import ComponentParams
from moseg.schemas.parameters.confidence import ConfidenceParams
from moseg.schemas.parameters.deaot import DeaotParams
from moseg.schemas.parameters.dense_tracks import DenseTrackParams
from moseg.schemas.parameters.depth import DepthParams
from moseg.schemas.parameters.depth_anything import DepthAnythingParams
from moseg.schemas.parameters.depth_anything_3 import DepthAnything3Params
from moseg.schemas.parameters.detections import DetectionParams
from moseg.schemas.parameters.dpt_dinov2 import DptDinov2Params
from moseg.schemas.parameters.flow import FlowParams
from moseg.schemas.parameters.flow_models import FlowModelParams
from moseg.schemas.parameters.foreground import ForegroundParams
from moseg.schemas.parameters.fundamental import FundamentalParams
from moseg.schemas.parameters.grounding_dino import GroundingDinoParams
from moseg.schemas.parameters.growing import GrowingParams
from moseg.schemas.parameters.identity import IdentityParams
from moseg.schemas.parameters.instances import InstanceParams, SeedParams
from moseg.schemas.parameters.linking import LinkingParams
from moseg.schemas.parameters.local_colours import LocalColourParams
from moseg.schemas.parameters.motion_memory import MotionMemoryParams
from moseg.schemas.parameters.motion_network import MotionNetworkParams
from moseg.schemas.parameters.motion_prompts import MotionPromptParams
from moseg.schemas.parameters.motion_proof import MotionProofParams
from moseg.schemas.parameters.moves_now import MovesNowParams
from moseg.schemas.parameters.moving_objects import MovingObjectParams
from moseg.schemas.parameters.network_training import NetworkTrainingParams
from moseg.schemas.parameters.object_hypotheses import ObjectHypothesisParams
from moseg.schemas.parameters.object_points import ObjectPointParams
from moseg.schemas.parameters.own_motion import OwnMotionParams
from moseg.schemas.parameters.pips import PipsParams
from moseg.schemas.parameters.plugins import PluginParams
from moseg.schemas.parameters.raft import RaftParams
from moseg.schemas.parameters.ram import RamParams
from moseg.schemas.parameters.refinement import RefinementParams
from moseg.schemas.parameters.repetitions import RepetitionParams
from moseg.schemas.parameters.rigid_support import RigidSupportParams
from moseg.schemas.parameters.rigidity import RigidityParams
from moseg.schemas.parameters.saliency import SaliencyParams
from moseg.schemas.parameters.sam2 import EdgeTamParams, Sam2Params
from moseg.schemas.parameters.sam3 import Sam3Params
from moseg.schemas.parameters.sam_hq import SamHqParams
from moseg.schemas.parameters.scene_cuts import SceneCutParams
from moseg.schemas.parameters.scene_parallax import SceneParallaxParams
from moseg.schemas.parameters.screen_graphics import ScreenGraphicsParams
from moseg.schemas.parameters.sea_raft import SeaRaftParams
from moseg.schemas.parameters.slow_motion import SlowMotionParams
from moseg.schemas.parameters.track_masks import TrackMaskParams
from moseg.schemas.parameters.track_objects import (
    CandidateParams,
    OwnVehicleParams,
    RegroupParams,
    TrackFieldParams,
    TrackGroupParams,
    TrackObjectParams,
)
from moseg.schemas.parameters.track_surfaces import TrackSurfaceParams
from moseg.schemas.parameters.track_window import TrackWindowParams
from moseg.schemas.parameters.tracks import TrackParams
from moseg.schemas.parameters.trajectories import (
    ClipSectionParams,
    CodingParams,
    EnergyParams,
    HypothesisParams,
    KernelParams,
    NoiseReductionParams,
    OutlierParams,
    PieceParams,
    SeparationParams,
    TrajectoryClusteringParams,
)
from moseg.schemas.parameters.video_network import VideoNetworkParams
from moseg.schemas.parameters.video_training import ClipParams, VideoTrainingParams

__all__ = [
    "AccumulationParams",
    "AffinityParams",
    "AppearanceParams",
    "BlackBarParams",
    "BootsTapirParams",
    "CameraParams",
    "CandidateParams",
    "CarryingParams",
    "ClipParams",
    "ClipSectionParams",
    "ClusteringParams",
    "CodingParams",
    "ComponentParams",
    "ConfidenceParams",
    "DeaotParams",
    "DenseTrackParams",
    "DepthAnything3Params",
    "DepthAnythingParams",
    "DepthParams",
    "DetectionParams",
    "DptDinov2Params",
    "EdgeTamParams",
    "EnergyParams",
    "FlowModelParams",
    "FlowParams",
    "ForegroundParams",
    "FundamentalParams",
    "GroundingDinoParams",
    "GrowingParams",
    "HypothesisAffinityParams",
    "HypothesisParams",
    "IdentityParams",
    "InstanceParams",
    "KernelParams",
    "LinkingParams",
    "LocalColourParams",
    "MotionCountParams",
    "MotionMemoryParams",
    "MotionNetworkParams",
    "MotionPromptParams",
    "MotionProofParams",
    "MovesNowParams",
    "MovingObjectParams",
    "NetworkTrainingParams",
    "NoiseReductionParams",
    "ObjectHypothesisParams",
    "ObjectPointParams",
    "OutlierParams",
    "OwnMotionParams",
    "OwnVehicleParams",
    "PieceParams",
    "PipsParams",
    "PluginParams",
    "RaftParams",
    "RamParams",
    "RefinementParams",
    "RegroupParams",
    "RepetitionParams",
    "RigidSupportParams",
    "RigidityParams",
    "SaliencyParams",
    "Sam2Params",
    "Sam3Params",
    "SamHqParams",
    "SceneCutParams",
    "SceneParallaxParams",
    "ScreenGraphicsParams",
    "SeaRaftParams",
    "SeedParams",
    "SeparationParams",
    "SlowMotionParams",
    "TrackFieldParams",
    "TrackGroupParams",
    "TrackMaskParams",
    "TrackObjectParams",
    "TrackParams",
    "TrackSurfaceParams",
    "TrackWindowParams",
    "TrajectoryClusteringParams",
    "VideoNetworkParams",
    "VideoTrainingParams",
]
