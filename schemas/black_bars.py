"""Black bars around a video's picture."""

from typing import NamedTuple


class BlackBars(NamedTuple):
    """Widths of the bars at the four sides, px; 0 where there is none."""

    left: int = 0
    top: int = 0
    right: int = 0
    bottom: int = 0

    @property
    def corner(self) -> tuple[int, int]:
        """The x and y of the picture's first pixel, px."""
        return self.left, self.top

    def picture(self, shape: tuple[int, int]) -> tuple[slice, slice]:
        """Return the rows and columns of the picture in frames of `shape`, which is (y, x), px."""
        height, width = shape
        return slice(self.top, height - self.bottom), slice(self.left, width - self.right)

    def picture_shape(self, shape: tuple[int, int]) -> tuple[int, int]:
        """Return the (y, x) of the picture in frames of `shape`, which is (y, x), px."""
        height, width = shape
        return height - self.top - self.bottom, width - self.left - self.right
