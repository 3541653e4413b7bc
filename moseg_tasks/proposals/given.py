"""Given masks (ground truth, or the user's) as object proposals of a section."""

import numpy as np


def relabel_masks(masks: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Number the objects of a section 1, 2, … in the order of their given identities.

    Parameters
    ----------
    masks : uint16 (frame, y, x)
        Given identities, 0 = background.

    Returns
    -------
    labels : uint16 (frame, y, x)
    identities : uint16 (object,)
        The given identity of each label from 1 on.
    """
    identities, inverse = np.unique(np.append(masks.reshape(-1), 0), return_inverse=True)
    labels = inverse[:-1].reshape(masks.shape).astype(np.uint16)
    return labels, identities[1:].astype(np.uint16)


def link_identities(names: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return the objects of the sequence from the given identities of each section's objects.

    Returns
    -------
    identity : uint16 (section, object)
        Object of the sequence of each section object; 0 in column 0 (background) and in unused columns.
    given : uint16 (object,)
        The given identity of each object of the sequence, from object 1 on.
    """
    given = np.unique(np.concatenate(names)) if names else np.empty(0, np.uint16)
    identity = np.zeros((len(names), 1 + max((len(n) for n in names), default=0)), np.uint16)
    for row, section in zip(identity, names, strict=True):
        row[1 : 1 + len(section)] = 1 + np.searchsorted(given, section)
    return identity, given.astype(np.uint16)
