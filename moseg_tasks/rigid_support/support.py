"""Support of objects for being part of a rigid scene, from the evidence of their tracks."""

from collections.abc import Sequence

import numpy as np

from moseg.schemas.parameters import RigidSupportParams
from moseg.tasks.rigid_support.object_evidence import ObjectEvidence


def support_of_evidence(
    evidence: ObjectEvidence, params: RigidSupportParams, sensitivity: float, min_gain: float
) -> np.ndarray:
    """Return whether each object is part of the rigid scene, float64 (K,): 1 = it is, 0 = it is not, NaN = open.

    An object that no rigid scene explains moves. What a rigid scene explains is static if it touches other things, at
    their depth, and if it has too few tracks to say: there is no evidence that it moves. But an object that stands free
    on all sides may as well move parallel to the camera, so it stays open. Before a blurred or plain background, few of
    its tracks have others near them: then it stands free if the scene has nothing at its depth either. All objects stay
    open if the camera's motion was found in no frame pair: they were compared with nothing. So do those that do not
    clearly move, if nothing but the objects shows depth: one motion before a plane looks like a near part of a rigid
    scene.

    Parameters
    ----------
    evidence : ObjectEvidence
    params : RigidSupportParams
    sensitivity : float
        Divisor of the evidence that a moving object needs.
    min_gain : float
        Least `ObjectEvidence.gain` by which the scene shows depth.
    """
    # Neighbouring pairs see nearly the same: what is skipped would have counted as much as what is read.
    is_known = params.step * evidence.num_observations >= params.min_observations / sensitivity
    moves = is_known & (evidence.test > params.max_test / sensitivity)
    shows_depth = evidence.gain >= min_gain
    has_contour = evidence.num_contour >= params.min_contour
    touches = np.where(evidence.num_contour > 0, evidence.attached, 0.0)
    beside = np.where(has_contour, touches, np.maximum(touches, evidence.accompanied))
    stands_free = is_known & (evidence.num_inside >= params.min_contour) & (beside < params.min_attached)
    support = np.where(moves, 0.0, np.where(stands_free | (not shows_depth), np.nan, 1.0))
    if evidence.num_pairs == 0:
        support[:] = np.nan
    support[0] = 1.0
    return support


def combine_sections(supports: Sequence[np.ndarray]) -> np.ndarray:
    """Return each object's support over all sections, float64 (K,).

    What moves in one section moves, also where it rests in another. What is open in one section and static in others is
    static.

    Parameters
    ----------
    supports : sequence of float64 (K,)
        Of each section, 0..1; NaN for objects that are open or not in it.
    """
    stacked = np.stack(supports)
    least = np.min(np.where(np.isnan(stacked), np.inf, stacked), axis=0)
    return np.where(np.isinf(least), np.nan, least)
