"""Colours of what moves and of the background, learnt from a video's own motion."""

from moseg.tasks.appearance.colour_bins import colour_bins
from moseg.tasks.appearance.histograms import ColourCount, count_colours
from moseg.tasks.appearance.ratio import colour_ratio, pool_sections

__all__ = ["ColourCount", "colour_bins", "colour_ratio", "count_colours", "pool_sections"]
