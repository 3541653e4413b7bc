"""The objects' support for being part of the rigid scene, over all sections."""

from collections.abc import Sequence

import numpy as np

from moseg.store import ArtifactStore


def read_rigid_support(store: ArtifactStore, refs: Sequence[str]) -> np.ndarray | None:
    """Return the support of the background and each object, float64 (K,): 1 = static, 0 = moves, NaN = open.

    Parameters
    ----------
    refs : sequence of references
        Rigid support in each section that was compared with a rigid scene; None is returned if there is none.
    """
    if not refs:
        return None
    # Here, because a program starts without SciPy.
    from moseg.tasks.rigid_support import combine_sections

    return combine_sections([store.read(ref, "support") for ref in refs])
