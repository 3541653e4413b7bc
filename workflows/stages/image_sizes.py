"""Batches of frames of one size: those of several sequences may have several."""

from collections.abc import Callable, Sequence

import numpy as np

from moseg.workflows.stages.inputs import Inputs


def run_by_image_size(
    run: Callable[[list[np.ndarray]], Sequence[np.ndarray]], inputs: Sequence[Inputs], roles: Sequence[str]
) -> list[np.ndarray]:
    """Return what a network makes of the images of several inputs, in their order.

    Parameters
    ----------
    run : function of arrays (N, y, x, 3)
        One array a role, of the N inputs whose images have one size; returns an array for each input.
    inputs : sequence of Inputs
    roles : sequence of str
        Of the images; those of one input have one size.
    """
    images = [[each[role].cached("image") for role in roles] for each in inputs]
    places: dict[tuple[int, ...], list[int]] = {}
    for place, (first, *_) in enumerate(images):
        places.setdefault(first.shape, []).append(place)
    found: dict[int, np.ndarray] = {}
    for alike in places.values():
        stacks = [np.stack([images[place][index] for place in alike]) for index in range(len(roles))]
        found |= dict(zip(alike, run(stacks), strict=True))
    return [found[place] for place in range(len(images))]
