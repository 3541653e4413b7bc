"""Artifacts on object stores: Amazon S3 and servers with its protocol, Google Cloud Storage, Azure Blob."""

from moseg.store.remote.remote_store import RemoteStore

__all__ = ["RemoteStore"]
