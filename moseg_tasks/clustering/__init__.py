"""Fusion of affinities, clustering of objects into motions, and the number of motions."""

from moseg.tasks.clustering.agreement import agreed_static
from moseg.tasks.clustering.cluster_motions import Clustering, cluster_motions
from moseg.tasks.clustering.count_motions import CountEvidence, MotionCount, count_motions
from moseg.tasks.clustering.motion_tracks import MotionTracks
from moseg.tasks.clustering.spectral import Embedding, embed_views

__all__ = [
    "Clustering",
    "CountEvidence",
    "Embedding",
    "MotionCount",
    "MotionTracks",
    "agreed_static",
    "cluster_motions",
    "count_motions",
    "embed_views",
]
