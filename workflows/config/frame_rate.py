"""The range of frame rates, and the choice of the rate of the results."""

from moseg.schemas.errors import InputError

DEFAULT_FPS = 24.0
"""Frames per second of frames that come without a rate: a folder of images, arrays."""
MIN_FPS, MAX_FPS = 0.1, 1000.0
"""Frames per second: a time lapse of ten seconds a frame, and a high-speed camera."""


def check_fps(fps: float, where: str) -> None:
    """Raise InputError, naming the argument `where`, on a rate beyond what an overlay is made for; also on NaN."""
    if not MIN_FPS <= fps <= MAX_FPS:
        expected = f"{MIN_FPS:g}..{MAX_FPS:g} frames per second"
        raise InputError("not a frame rate", where=where, got=fps, expected=expected)


def choose_fps(asked: float | None, own: float | None) -> float:
    """Return the frames per second of the results: the rate asked for, else the video's own, else `DEFAULT_FPS`."""
    return float(asked or own or DEFAULT_FPS)
