"""Where and with which libraries an artifact was computed."""

import platform
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version

RECORDED = (
    "moseg",
    "numpy",
    "scipy",
    "scikit-learn",
    "opencv-python-headless",
    "poselib",
    "torch",
    "zarr",
    "numcodecs",
)
"""Distributions whose code can change an artifact's bytes."""


@cache
def library_versions() -> dict[str, str]:
    """Version of Python and of each recorded distribution that is installed."""
    versions = {"python": platform.python_version()}
    for name in RECORDED:
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            continue
    return versions


def utc_now() -> str:
    """This moment, ISO 8601 with its zone."""
    return datetime.now(UTC).isoformat()
