"""Bytes: the content-addressed artifact store."""

from store.ahead import map_reads
from store.local import LocalStore
from store.nearest import FieldDifference, NearestRecipe, differences, nearest
from store.opening import open_store
from store.outcomes import GcReport, Pin, PutOutcome, StoredArtifact, TaskUsage, VerifyResult
from store.protocol import ArtifactStore

__all__ = [
    "ArtifactStore",
    "FieldDifference",
    "GcReport",
    "LocalStore",
    "NearestRecipe",
    "Pin",
    "PutOutcome",
    "StoredArtifact",
    "TaskUsage",
    "VerifyResult",
    "differences",
    "map_reads",
    "nearest",
    "open_store",
]
