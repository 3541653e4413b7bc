"""Objects and motion groups of scenes that were segmented apart, numbered as those of one video."""

from collections.abc import Sequence

import numpy as np


def join_objects(identities: Sequence[np.ndarray], names: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Number the objects of all scenes; those of a scene follow those of the scenes before it.

    Parameters
    ----------
    identities : sequence of uint16 (section, object)
        Of each scene: the object of the scene that each object of a section is, 0 = background.
    names : sequence of uint16 (object,)
        Of each scene: the identity of each of its objects in labels, the background's 0 first.

    Returns
    -------
    identity : uint16 (section, object)
        The object of the video that each object of a section is; the sections are those of all scenes.
    names : uint16 (object,)
        The identity of each object of the video in labels, the background's 0 first.
    """
    width = max(identity.shape[1] for identity in identities)
    rows, joined, num_before, last = [], [np.zeros(1, np.uint16)], 0, 0
    for identity, own in zip(identities, names, strict=True):
        moved = np.where(identity > 0, identity + np.uint16(num_before), np.uint16(0))
        rows.append(np.pad(moved, ((0, 0), (0, width - identity.shape[1]))))
        joined.append(own[1:] + np.uint16(last))
        num_before += len(own) - 1
        last = max(last, int(joined[-1].max(initial=0)))
    return np.concatenate(rows), np.concatenate(joined)


def join_motions(motions: Sequence[np.ndarray]) -> np.ndarray:
    """Number the motion groups of all scenes; those of a scene follow those of the scenes before it.

    Parameters
    ----------
    motions : sequence of uint16 (object,)
        Of each scene: the motion group of each of its objects, the background's 0 first; 0 is static in each scene.

    Returns
    -------
    uint16 (object,)
        The motion group of each object of the video, the background's 0 first.
    """
    joined = [np.zeros(1, np.uint16)]
    last = 0
    for motion in motions:
        joined.append(np.where(motion[1:] > 0, motion[1:] + np.uint16(last), np.uint16(0)))
        last = max(last, int(joined[-1].max(initial=0)))
    return np.concatenate(joined)
