"""Tiny random checkpoints in the official formats: with them every backend runs without its weights."""
