"""Artifacts on a local (or mounted) file system."""

from moseg.store.local.local_store import LocalStore

__all__ = ["LocalStore"]
