"""Slow motion: how far apart pictures must be for what moves to leave its place."""

from moseg.tasks.slow_motion.gap import SlowMotion, choose_gap

__all__ = ["SlowMotion", "choose_gap"]
