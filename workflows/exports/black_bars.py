"""Black bars around a video's picture: what they mean for the result."""

import math

from moseg.schemas.black_bars import BlackBars


def describe_bars(
    bars: BlackBars, analysed: tuple[int, int], shape: tuple[int, int], are_left_out: bool
) -> tuple[str, ...]:
    """Return what bars mean for the result, in one line, or nothing where there are none.

    Parameters
    ----------
    bars : BlackBars
        In frames of the size `analysed` (height, width).
    analysed, shape : (int, int)
        `shape` is the video's own size, in whose pixels the line gives widths.
    are_left_out : bool
        Whether they were filled for the analysis, else they were analysed as scene.
    """
    if not any(bars):
        return ()
    down, across = (size / small for size, small in zip(shape, analysed, strict=True))
    widths = {"left": bars.left * across, "above": bars.top * down}
    widths |= {"right": bars.right * across, "below": bars.bottom * down}
    named = ", ".join(f"{round(width)} px {side}" for side, width in widths.items() if width)
    if are_left_out:
        return (f"black bars ({named}) are left out: nothing is found in them",)
    # Encoders need even sizes.
    left, top, right, bottom = (2 * math.ceil(round(width, 6) / 2) for width in widths.values())
    kept = f"{(shape[1] - left - right) // 2 * 2}:{(shape[0] - top - bottom) // 2 * 2}:{left}:{top}"
    told = "count as scene, so that objects may be lost or wrong"
    return (f"black bars ({named}) {told}: cut them off first, as `ffmpeg -i IN -vf crop={kept} OUT` does",)
