"""The trained network from which a training goes on."""

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from moseg.tasks.motion_network.unet import MotionUNet


class Start(NamedTuple):
    """A trained network.

    Attributes
    ----------
    network : MotionUNet
        In its state of inference, with its normalisations merged into the convolutions.
    sha256 : str
        Of the bytes of its file.
    """

    network: "MotionUNet"
    sha256: str
