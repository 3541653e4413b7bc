"""Parameters of every stage, one file a stage."""

from schemas.parameters.affinity import AffinityParams
from schemas.parameters.clustering import ClusteringParams
from schemas.parameters.depth import DepthParams
from schemas.parameters.flow import FlowParams
from schemas.parameters.flow_models import FlowModelName, FlowModelParams
from schemas.parameters.fundamental import FundamentalParams
from schemas.parameters.saliency import LinkingParams, ProposalParams, SaliencyParams
from schemas.parameters.tracks import TrackParams

__all__ = [
    "AffinityParams",
    "ClusteringParams",
    "DepthParams",
    "FlowModelName",
    "FlowModelParams",
    "FlowParams",
    "FundamentalParams",
    "LinkingParams",
    "ProposalParams",
    "SaliencyParams",
    "TrackParams",
]
