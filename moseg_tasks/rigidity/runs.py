"""Runs of consecutive indices of different lengths, as flat arrays."""

import numpy as np


def expand_runs(start: np.ndarray, stop: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the indices start[i], ..., stop[i] - 1 of all i, and i of each: intp (P,) each, i first."""
    length = np.maximum(stop - start, 0)
    row = np.repeat(np.arange(len(start)), length)
    first = np.cumsum(length) - length
    return row, np.arange(len(row)) - first[row] + np.asarray(start)[row]
