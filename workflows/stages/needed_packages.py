"""Packages outside the default installation that a configuration needs, beside those of networks with weights."""

from importlib.util import find_spec

from moseg.schemas.configs import SALIENCY_SOURCES, PipelineConfig
from moseg.schemas.errors import InputError


def require_packages(config: PipelineConfig) -> None:
    """Raise InputError, with both ways out, if a configuration trains networks on the video where torch is missing."""
    if config.video_network.use == "never" or config.proposal_source not in SALIENCY_SOURCES:
        return
    if find_spec("torch") is None:
        expected = "pip install 'moseg[models]', or --set video_network.use=never"
        raise InputError("a network trained on the video needs torch", got="not installed", expected=expected)
