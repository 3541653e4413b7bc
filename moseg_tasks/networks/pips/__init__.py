"""Persistent independent particles (PIPs): a network that follows points through windows of eight frames."""

from moseg_tasks.networks.pips.build import build_pips
from moseg_tasks.networks.pips.config import PipsConfig
from moseg_tasks.networks.pips.model import Pips
from moseg_tasks.networks.pips.resolution import Resolution

__all__ = ["Pips", "PipsConfig", "Resolution", "build_pips"]
