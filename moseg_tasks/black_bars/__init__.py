"""Black bars around a video's picture: found, filled for the analysis, and kept free of objects."""

from moseg.tasks.black_bars.clear import InsideObjects, clear_bars, keep_inside
from moseg.tasks.black_bars.fill import fill_bars
from moseg.tasks.black_bars.find import find_bars

__all__ = ["InsideObjects", "clear_bars", "fill_bars", "find_bars", "keep_inside"]
