"""Versions of the libraries with which an artifact was computed."""

import platform
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
    """Return the version of Python and of each recorded distribution that is installed."""
    versions = {"python": platform.python_version()}
    for name in RECORDED:
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            continue
    return versions
