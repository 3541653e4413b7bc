"""Height above the ground of the bottom of the surface that a track belongs to.

A static surface stands on the ground: its parallax is that of the ground at its own foot. A car that comes towards the
camera along its epipolar lines moves like something nearer than it is, so that its foot seems to hang in the air.
"""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.ground import Ground
from moseg.tasks.rigidity.parallax import Parallax
from moseg.tasks.rigidity.runs import expand_runs

_MINIMAL_SURFACE = 3  # tracks
_FLOOR = 1e-6  # inverse depth of a track that may belong to a surface
_BELOW = 1.3  # camera heights; the apparent foot of what hangs lies below its ground by less than that
_SAME_SURFACE = 0.2  # largest difference of inverse depth in the strip below a track, share
_GROUND_NOISE, _GROUND_SLACK = 2.0, 0.1  # of a track on the ground: in its noise, and as a share of the parallax
_MARGIN = 0.35  # additional half width of the strip in which ground is looked for, camera heights
_SHADOW = 0.1  # rows above the apparent contact that need not show ground, camera heights
_CUT_OFF = 0.15  # rows above the frame's lower edge in which a surface's foot may be cut off, camera heights


def contact_excess(
    points: np.ndarray,
    parallax: Parallax,
    ground: Ground,
    shape: tuple[int, int],
    noise: np.ndarray,
    params: RigidityParams,
) -> tuple[np.ndarray, np.ndarray]:
    """Return how far a track's surface seems to hang above the ground, beyond what needs no motion.

    Parameters
    ----------
    points : float64 (N, 2)
        xy of the tracks in frame 0, px.
    parallax : Parallax
        Of these tracks.
    ground : Ground
    shape : (height, width)
        Of the frame.
    noise : float64 (N,)
        Of their displacements, px.
    params : RigidityParams

    Returns
    -------
    excess : float64 (N,)
        In standard deviations; 0 where nothing hangs or nothing is known.
    height : float64 (N,)
        Apparent height of the surface's bottom in heights of the camera; 0 where the excess is 0.
    """
    num_tracks = len(points)
    excess, height = np.zeros(num_tracks), np.zeros(num_tracks)
    below = ground.inverse_depth(points)
    ground_parallax = parallax.at(np.maximum(below, 0))
    inverse_depth, along = parallax.inverse_depth, parallax.along
    # The ground falls by one camera height over this many rows at a track's inverse depth.
    camera_height = inverse_depth / ground.slope[1]
    upright = np.flatnonzero(
        (along > params.contact_parallax * ground_parallax + 2 * noise)
        & (inverse_depth > _FLOOR)
        & (camera_height > params.contact_size)
        & (1 - below / np.maximum(inverse_depth, _FLOOR) < _BELOW)
        & (np.abs(parallax.across) < 3 * noise)
    )
    depth_noise = noise / parallax.reach
    surface = _surfaces(points[upright], inverse_depth[upright], depth_noise[upright], params)
    upright, surface = upright[surface >= 0], surface[surface >= 0]
    half = params.contact_width + params.contact_growth * camera_height[upright]
    bottom = _bottom_rows(points[upright], inverse_depth[upright], surface, half)
    foot = np.column_stack([points[upright, 0], bottom])
    lifted = 1 - ground.inverse_depth(foot) / inverse_depth[upright]
    # Rows nearer to the contact are not told from the ground: even a surface that stands on it seems to end above.
    unseen = 1 - (1 - 2 * noise[upright] / along[upright]) / params.contact_parallax
    hangs = (lifted > np.maximum(params.contact_lift, unseen + params.contact_margin)) & (lifted < params.contact_top)
    # The ground beside a foot that the frame cuts off would pass for the ground below it.
    hangs &= bottom < shape[0] - _CUT_OFF * camera_height[upright]
    upright, half, bottom, lifted = upright[hangs], half[hangs], bottom[hangs], lifted[hangs]
    ground_noise = _GROUND_NOISE * noise + _GROUND_SLACK * ground_parallax
    is_ground = (np.abs(ground_parallax - along) < ground_noise) & (below > 0)
    is_raised = ~is_ground & (inverse_depth > below)
    size = camera_height[upright]
    rows = bottom + 1, bottom + (lifted - _SHADOW) * size + 1
    is_seen = _ground_is_seen(points, is_ground, is_raised, upright, half + _MARGIN * size, rows)
    upright, lifted, size = upright[is_seen], lifted[is_seen], size[is_seen]
    relative = depth_noise[upright] / inverse_depth[upright]
    spread = np.sqrt(params.contact_noise**2 + (params.contact_noise_pixels / size) ** 2 + relative**2)
    excess[upright], height[upright] = (lifted - params.contact_lift) / spread, lifted
    return excess, height


def _surfaces(points, inverse_depth, depth_noise, params: RigidityParams) -> np.ndarray:
    """Return the surface of each track, int (N,): a component of neighbours at one depth; -1 for one of few tracks."""
    if len(points) == 0:
        return np.zeros(0, np.intp)
    tree = KDTree(points * [params.contact_stretch, 1.0])
    first, second = tree.query_pairs(params.contact_reach, output_type="ndarray").T
    nearest = np.maximum(inverse_depth[first], inverse_depth[second])
    tolerance = params.contact_agreement * nearest + np.hypot(depth_noise[first], depth_noise[second])
    alike = np.abs(inverse_depth[first] - inverse_depth[second]) < tolerance
    edges = (np.ones(np.count_nonzero(alike), bool), (first[alike], second[alike]))
    _, surface = connected_components(coo_matrix(edges, (len(points),) * 2), directed=False)
    return np.where(np.bincount(surface)[surface] >= _MINIMAL_SURFACE, surface, -1)


def _bottom_rows(points, inverse_depth, surface, half) -> np.ndarray:
    """Return the lowest row of each track's surface at its depth, in a strip of `half` the width (N,), px."""
    x, y = points.T
    if len(points) == 0:
        return y
    width = np.ptp(x) + 1
    half = np.minimum(half, width)
    # Surfaces side by side: a strip never reaches the next one.
    place = x + 3 * width * surface
    order = np.argsort(place)
    start, stop = (np.searchsorted(place[order], place + sign * half) for sign in (-1, 1))
    row, inside = expand_runs(start, stop)
    other = order[inside]
    alike = np.abs(inverse_depth[other] - inverse_depth[row]) < _SAME_SURFACE * inverse_depth[row]
    bottom = y.copy()
    np.maximum.at(bottom, row[alike], y[other[alike]])
    return bottom


def _ground_is_seen(points, is_ground, is_raised, tracks, half, rows) -> np.ndarray:
    """Return whether the ground shows between two rows below each of the tracks (M,).

    It does not where more rises from it: things that hide it, or terrain. What stands on a bank hangs above the plane
    of the road.
    """
    order = np.argsort(points[:, 0])
    x, y = points[order].T
    start, stop = (np.searchsorted(x, points[tracks, 0] + sign * half) for sign in (-1, 1))
    row, inside = expand_runs(start, stop)
    other = order[inside]
    between = (y[inside] > rows[0][row]) & (y[inside] < rows[1][row])
    num_ground = np.bincount(row[between & is_ground[other]], minlength=len(tracks))
    num_raised = np.bincount(row[between & is_raised[other]], minlength=len(tracks))
    return (num_ground >= 1) & (num_ground > 2 * num_raised)
