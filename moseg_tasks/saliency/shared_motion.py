"""Motion between frames right beside each other, from that between frames farther apart."""

from collections.abc import Sequence

import numpy as np


def share_out(flows: np.ndarray, shares: Sequence[float], is_given: Sequence[bool]) -> np.ndarray:
    """Return the share of a frame's flows that lies between it and the frames right beside it.

    At the ends of a scene there is no picture several away. What moves goes on as it does on the other side.

    Parameters
    ----------
    flows : float16 (2, h, w, 2)
        To the previous and to the next of the frames that were compared; zeros where there is none.
    shares : two of float
        1 where the frame compared is the one beside, less if it is farther, 0 if the one beside shows the same.
    is_given : two of bool
        Whether there is a picture to compare the frame with.

    Returns
    -------
    float16 (2, h, w, 2)
    """
    shared = np.zeros_like(flows)
    for direction, (share, given) in enumerate(zip(shares, is_given, strict=True)):
        own, other = flows[direction], flows[1 - direction]
        shared[direction] = (own if share == 1 or given else -other) * flows.dtype.type(share)
    return shared
