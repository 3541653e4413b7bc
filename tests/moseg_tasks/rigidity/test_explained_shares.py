import numpy as np
import pytest

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.explained_shares import share_of_plane

PARAMS = RigidityParams()
CORNERS = 2 + PARAMS.pose_cell * np.array([[1.0, 1], [12, 2], [2, 9], [14, 10]])
BESIDE = np.array([[0.0, 0], [5, 1], [2, 6]])
MOVED = np.array([6.0, 2.0])


def _tracks(num_cells):
    """Return three tracks in each of some cells, xy, px."""
    return (CORNERS[:num_cells, None] + BESIDE).reshape(-1, 2)


@pytest.mark.parametrize("num_cells", [1, 2, 3, 4])
def test_a_plane_explains_tracks_in_too_few_cells_to_tell_it_from_others(num_cells):
    points = _tracks(num_cells)
    assert share_of_plane(points, points + MOVED, 1.4, PARAMS) == 1


def test_one_plane_does_not_explain_the_tracks_of_another():
    points = np.stack(np.meshgrid(np.arange(10.0, 300, 20), np.arange(10.0, 200, 20)), axis=-1).reshape(-1, 2)
    is_near = points[:, 1] > 140
    share = share_of_plane(points, points + np.where(is_near[:, None], 3 * MOVED, MOVED), 1.4, PARAMS)
    assert share == pytest.approx(1 - is_near.mean())
