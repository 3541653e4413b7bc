"""Frozen models of recipes, manifests, configurations and scores, and the errors."""
