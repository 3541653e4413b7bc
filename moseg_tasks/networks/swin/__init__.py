"""Swin Transformer: an image encoder of attention within shifted windows."""

from moseg.tasks.networks.swin.config import SwinConfig
from moseg.tasks.networks.swin.encoder import SwinEncoder

__all__ = ["SwinConfig", "SwinEncoder"]
