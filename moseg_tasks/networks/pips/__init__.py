"""Persistent independent particles (PIPs): a network that tracks points through windows of eight frames."""

from moseg.tasks.networks.pips.config import PipsConfig
from moseg.tasks.networks.pips.model import Pips, build_pips
from moseg.tasks.networks.pips.resolution import Resolution

__all__ = ["Pips", "PipsConfig", "Resolution", "build_pips"]
