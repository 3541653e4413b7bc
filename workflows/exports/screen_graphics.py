"""Graphics drawn into a video's frames: what they mean for the result."""

from moseg.schemas.screen_graphics import Polygon, ScreenGraphics

_MOST_NAMED = 4


def describe_graphics(
    graphics: ScreenGraphics, analysed: tuple[int, int], shape: tuple[int, int], are_left_out: bool
) -> tuple[str, ...]:
    """Return what graphics mean for the result, in one line, or nothing where there are none.

    Parameters
    ----------
    graphics : ScreenGraphics
        In frames of the size `analysed` (height, width).
    analysed, shape : (int, int)
        `shape` is the video's own size, in whose pixels the line gives places.
    are_left_out : bool
        Whether they were filled for the analysis, else they were analysed as scene.
    """
    if not graphics.parts:
        return ()
    down, across = (size / small for size, small in zip(shape, analysed, strict=True))
    named = [_describe_box(part, across, down) for part in graphics.parts[:_MOST_NAMED]]
    places = "; ".join(named if len(named) == len(graphics.parts) else [*named, "and others"])
    if are_left_out:
        return (f"graphics in the frames ({places}) are left out: what is around them stands for them",)
    return (f"graphics in the frames ({places}) count as scene: they may be taken for objects",)


def _describe_box(part: Polygon, across: float, down: float) -> str:
    """Return size and place of a part's bounding box, px."""
    (left, right), (top, bottom) = ((min(each), max(each) + 1) for each in zip(*part, strict=True))
    width, height = round((right - left) * across), round((bottom - top) * down)
    return f"{width} x {height} px at {round(max(left, 0) * across)}, {round(max(top, 0) * down)}"
