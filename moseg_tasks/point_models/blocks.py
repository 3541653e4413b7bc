"""Residuals of many models in blocks that fit in the processor's cache."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import DTypeLike

_WORK_BYTES = 2**20  # of all work arrays together: they fit in a core's second-level cache


def combine_products(
    factors: list[tuple[np.ndarray, np.ndarray]],
    combine: Callable[[np.ndarray, np.ndarray], None],
    num_spare: int,
    dtype: DTypeLike,
) -> np.ndarray:
    """Combine matrix products over models and points into one number each.

    Allocation costs more than the arithmetic here, so the products of a block of models overwrite those of the last.

    Parameters
    ----------
    factors : list of (float64 (..., H, K), float64 (..., K, N))
        Coefficients of H models and monomials of N points; K differs between factors.
    combine : callable
        Its arguments are the products of a block, (J + num_spare, ..., h, N) with J = len(factors), which it may
        overwrite, and the block of the result (..., h, N), which it must fill.
    num_spare : int
        Work arrays in addition to the products.
    dtype : float64 or float32

    Returns
    -------
    (..., H, N)
    """
    left = [coefficients.astype(dtype, copy=False) for coefficients, _ in factors]
    right = [monomials.astype(dtype, copy=False) for _, monomials in factors]
    lead = np.broadcast_shapes(left[0].shape[:-2], right[0].shape[:-2])
    num_models, num_points = left[0].shape[-2], right[0].shape[-1]
    result = np.empty((*lead, num_models, num_points), dtype)
    num_arrays = len(factors) + num_spare
    row_bytes = max(num_arrays * num_points * math.prod(lead) * result.itemsize, 1)
    rows = max(1, _WORK_BYTES // row_bytes)
    work = np.empty((num_arrays, *lead, min(rows, num_models), num_points), dtype)
    for start in range(0, num_models, rows):
        block = slice(start, min(start + rows, num_models))
        products = work[..., : block.stop - start, :]
        for product, coefficients, monomials in zip(products, left, right, strict=False):
            np.matmul(coefficients[..., block, :], monomials, out=product)
        combine(products, result[..., block, :])
    return result


def sum_of_squares(products: np.ndarray, squared: np.ndarray) -> None:
    """Fill `squared` with the sum of the squares of two products, for `combine_products`."""
    products *= products
    np.add(products[0], products[1], out=squared)
