"""RAM and RAM++: image tagging by cross-attention from a list of tags to an image's tokens."""

from moseg.tasks.networks.ram.build import Tagger, build_ram, build_ram_plus
from moseg.tasks.networks.ram.config import RamConfig
from moseg.tasks.networks.ram.model import Ram, RamPlus

__all__ = ["Ram", "RamConfig", "RamPlus", "Tagger", "build_ram", "build_ram_plus"]
