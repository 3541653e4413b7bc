"""Tiny random checkpoints in the official formats: they let every backend be run without its weights."""
