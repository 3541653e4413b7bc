"""Minimal samples from a few objects at a time: hypotheses of one motion, yet of more than one place."""

import numpy as np


def draw_object_samples(
    owner: np.ndarray, sample_size: int, num_samples: int, num_objects: int, rng: np.random.Generator
) -> np.ndarray:
    """Tracks of random minimal samples, each from the union of a few random objects.

    A sample of the whole frame is of one motion with the motion's share of the tracks to the power of the sample size:
    where the background shows few of them, never. A sample of one object is of one motion but says nothing of what
    lies beyond it. A few objects are often of one motion and always of several places.

    Parameters
    ----------
    owner : integer (N,)
        Object of each track.
    sample_size : int
        At most N.
    num_samples : int
    num_objects : int
        Objects that a sample is drawn from, all equally likely; inside their union so are all tracks. Where these are
        too few, the rest of the sample is of the other objects.
    rng : numpy.random.Generator

    Returns
    -------
    intp (num_samples, sample_size)
        Without repetition inside a sample.
    """
    _, inverse = np.unique(owner, return_inverse=True)
    place = np.argsort(rng.random((num_samples, inverse.max() + 1)), axis=1)
    is_outside = (place >= num_objects)[:, inverse]
    keys = rng.random((num_samples, len(owner))) + is_outside
    return np.argpartition(keys, sample_size - 1, axis=1)[:, :sample_size]
