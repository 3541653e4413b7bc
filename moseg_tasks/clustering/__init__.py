"""Fusion of affinities and clustering of objects into motions."""

from moseg_tasks.clustering.agreement import agreed_static
from moseg_tasks.clustering.cluster_motions import Clustering, cluster_motions
from moseg_tasks.clustering.spectral import Embedding, embed_views

__all__ = ["Clustering", "Embedding", "agreed_static", "cluster_motions", "embed_views"]
