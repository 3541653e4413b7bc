"""Numbers and durations as a page prints them."""

import math


def short_number(value: float, digits: int = 3) -> str:
    """Format a number with few significant digits, as ``0.0421``, ``1.2e−5`` or ``−∞``; an en dash for NaN."""
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    # A negative zero, also one from rounding, has no sign.
    value = value if abs(value) > 1e-300 else 0.0
    magnitude = abs(value)
    if magnitude and not 1e-3 <= magnitude < 1e5:
        mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
        text = f"{_without_trailing_zeros(mantissa)}e{int(exponent)}"
    elif magnitude >= 10 ** (digits - 1):
        text = f"{value:.0f}"
    else:
        text = _without_trailing_zeros(f"{value:.{digits}g}")
    return text.replace("-", "−")


def _without_trailing_zeros(text: str) -> str:
    return text.rstrip("0").rstrip(".") if "." in text else text


def duration(seconds: float) -> str:
    """Format seconds: ``340 ms``, ``4.2 s``, ``3 min 05 s``, ``2 h 10 min``."""
    if seconds < 0.9995:
        return f"{seconds * 1000:.0f} ms"
    if seconds < 59.95:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    if minutes < 60:
        return f"{minutes} min {rest:02d} s"
    hours, minutes = divmod(round(seconds / 60), 60)
    return f"{hours} h {minutes:02d} min"


def byte_count(count: int) -> str:
    """Format a number of bytes, as ``12 kB`` or ``3.4 MB``."""
    return f"{max(1, round(count / 1e3))} kB" if count < 1e6 else f"{count / 1e6:.1f} MB"
