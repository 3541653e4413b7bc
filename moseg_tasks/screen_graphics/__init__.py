"""Graphics drawn into a video's frames, such as logos and clocks: found, filled, and not followed."""

from moseg.tasks.screen_graphics.fill import fill_graphics, graphics_mask
from moseg.tasks.screen_graphics.find import find_graphics
from moseg.tasks.screen_graphics.points import end_hidden, pairs_outside

__all__ = ["end_hidden", "fill_graphics", "find_graphics", "graphics_mask", "pairs_outside"]
