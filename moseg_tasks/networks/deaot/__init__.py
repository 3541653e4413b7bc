"""DeAOT: masks of many objects propagated through a video from frames in memory."""

from moseg.tasks.networks.deaot.config import DeaotConfig
from moseg.tasks.networks.deaot.network import STRIDE, Deaot, Encoded, build_deaot
from moseg.tasks.networks.deaot.propagation import LayerMemory, extend_memory

__all__ = ["STRIDE", "Deaot", "DeaotConfig", "Encoded", "LayerMemory", "build_deaot", "extend_memory"]
