"""Colours and textures of what moves and of the background, learnt from a video's own motion."""

from moseg.tasks.appearance.histograms import ColourCount, colour_bins, count_colours, count_sides, histogram_shape
from moseg.tasks.appearance.ratio import colour_ratio, pool_sections

__all__ = [
    "ColourCount",
    "colour_bins",
    "colour_ratio",
    "count_colours",
    "count_sides",
    "histogram_shape",
    "pool_sections",
]
