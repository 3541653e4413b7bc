"""Bytes: the content-addressed artifact store."""

from moseg.store.ahead import map_reads
from moseg.store.local import LocalStore
from moseg.store.nearest import FieldDifference, NearestRecipe, differences, nearest
from moseg.store.opening import open_store
from moseg.store.outcomes import GcReport, Pin, PutOutcome, StoredArtifact, TaskUsage, VerifyResult
from moseg.store.protocol import ArtifactStore

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
