"""Parameters of every stage, one file a stage."""

from schemas.parameters.affinity import AffinityParams
from schemas.parameters.clustering import ClusteringParams
from schemas.parameters.deaot import DeaotParams
from schemas.parameters.depth import DepthParams
from schemas.parameters.depth_anything import DepthAnythingParams
from schemas.parameters.detections import DetectionParams
from schemas.parameters.dpt_dinov2 import DptDinov2Params
from schemas.parameters.flow import FlowParams
from schemas.parameters.flow_models import FlowModelName, FlowModelParams
from schemas.parameters.fundamental import FundamentalParams
from schemas.parameters.grounding_dino import GroundingDinoParams
from schemas.parameters.instances import InstanceParams, SeedParams
from schemas.parameters.pips import PipsParams
from schemas.parameters.raft import RaftParams
from schemas.parameters.ram import RamParams
from schemas.parameters.saliency import LinkingParams, ProposalParams, SaliencyParams
from schemas.parameters.sam2 import Sam2Params
from schemas.parameters.sam_hq import SamHqParams
from schemas.parameters.tracks import TrackParams

__all__ = [
    "AffinityParams",
    "ClusteringParams",
    "DeaotParams",
    "DepthAnythingParams",
    "DepthParams",
    "DetectionParams",
    "DptDinov2Params",
    "FlowModelName",
    "FlowModelParams",
    "FlowParams",
    "FundamentalParams",
    "GroundingDinoParams",
    "InstanceParams",
    "LinkingParams",
    "PipsParams",
    "ProposalParams",
    "RaftParams",
    "RamParams",
    "SaliencyParams",
    "Sam2Params",
    "SamHqParams",
    "SeedParams",
    "TrackParams",
]
