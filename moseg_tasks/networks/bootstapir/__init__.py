"""BootsTAPIR: a network that tracks points through whole sections, also through occlusions."""

from moseg.tasks.networks.bootstapir.config import BootsTapirConfig
from moseg.tasks.networks.bootstapir.model import BootsTapir, FeatureGrid, Trajectories, build_bootstapir

__all__ = ["BootsTapir", "BootsTapirConfig", "FeatureGrid", "Trajectories", "build_bootstapir"]
