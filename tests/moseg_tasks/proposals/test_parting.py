import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.identity import IdentityParams
from moseg.tasks.proposals import part_distant

PARAMS = IdentityParams()
SHAPE = (80, 200)
SIZE = 20
"""Side of a box, px."""
NUM_FRAMES = 20
LABEL = 3


def boxes(*paths, num_frames=NUM_FRAMES):
    """Boxes whose left edges are at path(t), px: their numbers (T, h, w), and the flow to both neighbours."""
    truth = np.zeros((num_frames, *SHAPE), np.uint16)
    flows = np.zeros((num_frames, 2, *SHAPE, 2), np.float32)
    for number, path in enumerate(paths, start=1):
        for t in range(num_frames):
            inside = np.zeros(SHAPE, bool)
            inside[30 : 30 + SIZE, int(path(t)) : int(path(t)) + SIZE] = True
            truth[t][inside] = number
            for direction, other in ((0, t - 1), (1, t + 1)):
                if 0 <= other < num_frames:
                    flows[t, direction][inside] = [int(path(other)) - int(path(t)), 0]
    return truth, flows


def parting(speed=4, start=0):
    """Two boxes side by side, both moving to the right, of which one is faster from `start` on."""
    return boxes(lambda t: 10 + 2 * t, lambda t: 10 + SIZE + 2 * t + speed * max(t - start, 0))


def parts_of(truth, flows, **arguments):
    params = PARAMS.model_copy(update={name: arguments.pop(name) for name in set(arguments) - {"gap"}})
    return part_distant((truth > 0).astype(np.uint16) * LABEL, flows, params, **arguments)


def num_parts(*scene, **arguments) -> int:
    return len(np.unique(parts_of(*scene, **arguments))) - 1


def assert_same_objects(labels: np.ndarray, truth: np.ndarray) -> None:
    """Each true object has one label of its own, in all frames."""
    pairs = np.unique(np.stack([labels.ravel(), truth.ravel()]), axis=1)
    assert pairs.shape[1] == len(np.unique(truth)) == len(np.unique(labels))


def test_objects_that_part_are_parted_where_they_touch_too():
    truth, flows = parting()
    labels = parts_of(truth, flows)
    assert_same_objects(labels, truth)
    assert set(np.unique(labels)) == {0, LABEL, LABEL + 1}
    assert labels.dtype == np.int32


def test_objects_that_meet_are_parted_as_well():
    truth, flows = (array[::-1] for array in parting())
    assert_same_objects(parts_of(truth, flows[:, ::-1]), truth)


def test_each_of_several_objects_has_a_label():
    scene = boxes(lambda t: 5 + t, lambda t: 5 + SIZE + 3.5 * t, lambda t: 5 + 2 * SIZE + 6 * t)
    assert_same_objects(parts_of(*scene), scene[0])
    assert num_parts(*scene, split_parts=2) == 2
    assert num_parts(*scene, split_parts=1) == 1


def test_objects_that_part_later_are_parted_too():
    scene = boxes(lambda t: 10, lambda t: 60, lambda t: 60 + SIZE + 4 * max(t - 20, 0), num_frames=40)
    scene[0][15:][scene[0][15:] == 1] = 0
    assert_same_objects(parts_of(*scene), scene[0])


def test_what_appears_elsewhere_for_a_moment_belongs_to_the_largest_object():
    truth, flows = boxes(lambda t: 10, lambda t: 100)
    truth[:, 20:30, 10:30] = 1
    # The first two are in the frame of most pieces, from which the others are carried.
    truth[5, 5:15, 50:60] = truth[5, 65:75, 50:60] = 1
    truth[10:13, 30:50, 150:170] = 1
    assert_same_objects(parts_of(truth, flows), truth)


def test_fast_objects_are_parted_along_the_flow():
    scene = boxes(lambda t: 5 + 5 * t, lambda t: 5 + SIZE + 5 * t + 3 * max(t - 2, 0))
    assert_same_objects(parts_of(*scene), scene[0])


@pytest.mark.parametrize("distance", [0.5, 1.0, 1.5])
def test_pieces_are_far_apart_by_their_width(distance):
    gap = 22
    truth, flows = boxes(lambda t: 10, lambda t: 10 + SIZE + gap if t > 5 else 10 + SIZE)
    assert num_parts(truth, flows, part_distance=distance) == (2 if gap + 1 > distance * SIZE else 1)


def test_what_a_pole_hides_in_part_stays_one_object():
    truth, flows = boxes(lambda t: 20 + 2 * t, lambda t: 20 + SIZE + 2 * t)
    truth[:, :, 60:66] = 0
    assert num_parts(truth, flows) == 1


@pytest.mark.parametrize(("num_frames", "gap"), [(7, 1), (8, 1), (15, 2), (16, 2)])
def test_pieces_are_apart_for_some_frames_on_end(num_frames, gap):
    apart = range(2, 2 + num_frames)
    scene = boxes(lambda t: 10, lambda t: 90 if t in apart else 10 + SIZE)
    assert num_parts(*scene, gap=gap) == (2 if num_frames >= gap * PARAMS.part_frames else 1)


def test_what_is_seen_shortly_is_not_parted():
    truth, flows = boxes(lambda t: 10, lambda t: 90)
    truth[4:] = 0
    assert num_parts(truth, flows) == 1


def test_all_frames_of_a_short_section_suffice():
    scene = boxes(lambda t: 10, lambda t: 90, num_frames=3)
    assert num_parts(*scene) == 2


def test_specks_are_no_objects_of_their_own():
    truth, flows = boxes(lambda t: 10)
    truth[:, 70:72, 150:152] = 1
    assert num_parts(truth, flows) == 1
    truth, flows = parting()
    truth[:, 5:7, 10:12] = 1
    assert num_parts(truth, flows) == 2


def test_specks_here_and_there_are_no_object():
    truth, flows = boxes(lambda t: 10)
    for t in range(NUM_FRAMES):
        left = 60 + 37 * t % 120
        truth[t, 5:9, left : left + 10] = 1
    assert num_parts(truth, flows) == 1


def test_a_small_object_that_touches_a_large_one_and_leaves_is_one():
    truth, flows = boxes(lambda t: min(10 + 4 * t, 90) if t < 25 else 90 - 4 * (t - 25), num_frames=46)
    large = truth[:, 5:75, 110:180]
    large[:] = 2
    assert (truth == 1).sum() < 0.1 * (truth == 2).sum()
    assert_same_objects(parts_of(truth, flows, part_distance=0.5), truth)


def test_objects_that_are_hidden_for_a_while_are_the_same_afterwards():
    truth, flows = boxes(lambda t: 10 + 2 * t, lambda t: 60 + 2 * t, num_frames=40)
    truth[14:22] = 0
    assert_same_objects(parts_of(truth, flows), truth)


def test_the_largest_label_may_be_that_of_the_dtype():
    truth, flows = parting()
    labels = (truth > 0).astype(np.uint16) * 65535
    assert set(np.unique(part_distant(labels, flows, PARAMS))) == {0, 65535, 65536}


def test_other_components_stay_as_they_are():
    truth, flows = parting()
    labels = (truth > 0).astype(np.uint16)
    labels[:, 70:78, :20] = 2
    found = part_distant(labels, flows, PARAMS)
    np.testing.assert_array_equal(found == 2, labels == 2)
    assert set(np.unique(found)) == {0, 1, 2, 3}


def test_nothing_has_no_parts():
    truth, flows = boxes()
    np.testing.assert_array_equal(parts_of(truth, flows), truth)


def test_flows_of_other_frames_are_an_error():
    truth, flows = parting()
    with pytest.raises(InputError, match="flows are not those of the labels"):
        parts_of(truth, flows[1:])
