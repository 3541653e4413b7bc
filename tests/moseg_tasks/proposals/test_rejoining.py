import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.identity import IdentityParams
from moseg.tasks.proposals.rejoining import rejoin_components

PARAMS = IdentityParams()
SHAPE = (70, 160)
NUM_FRAMES = 30
PILLAR = slice(70, 100)
RED, BLUE = (200, 40, 40), (40, 40, 200)


class Scene:
    """Squares that move behind a pillar, under a camera that moves by `camera` px/frame."""

    def __init__(self, camera=(0.0, 0.0)):
        self.labels = np.zeros((NUM_FRAMES, *SHAPE), np.uint16)
        self.images = np.random.default_rng(2).integers(90, 130, (NUM_FRAMES, *SHAPE, 3), dtype=np.uint8)
        self.images[:, :, PILLAR] = (90, 140, 90)
        self.residual = np.zeros((NUM_FRAMES, 2, *SHAPE, 2), np.float32)
        self.camera = np.array(camera)

    def add(self, label, path, frames=range(NUM_FRAMES), colour=RED, size=20):
        """A square centred on path(t) xy in the frames given, where it is not behind the pillar."""
        y, x = np.mgrid[: SHAPE[0], : SHAPE[1]]
        for t in frames:
            centre = np.array(path(t), float)
            inside = (abs(x - centre[0]) <= size / 2) & (abs(y - centre[1]) <= size / 2)
            inside[:, PILLAR] = False
            self.labels[t][inside] = label
            self.images[t][inside] = colour
            for direction, other in ((0, t - 1), (1, t + 1)):
                self.residual[t, direction][inside] = path(other) - centre - self.camera * (other - t)
        return self

    @property
    def flows(self):
        flows = self.residual.copy()
        flows[:, 0] -= self.camera
        flows[:, 1] += self.camera
        return flows

    def rejoin(self, params=PARAMS):
        return rejoin_components(self.labels, self.images, self.flows, self.residual, params)


def line(x, velocity, y=35.0):
    return lambda t: np.array([x + velocity * t, y])


def hidden(camera=(0.0, 0.0), **after) -> Scene:
    scene = Scene(camera).add(5, line(20, 4.5), range(13))
    return scene.add(2, **{"path": line(20, 4.5), "frames": range(16, 27), **after})


def test_an_object_that_reappears_keeps_its_label():
    result = hidden().rejoin()
    assert set(np.unique(result)) == {0, 5}
    assert ((result > 0) == (hidden().labels > 0)).all()


def test_the_camera_may_move_meanwhile():
    scene = Scene((-3.0, 1.0))
    for label, frames in ((5, range(13)), (2, range(16, 27))):
        scene.add(label, lambda t: np.array([20 + 4.5 * t, 20 + 1.0 * t]), frames)
    assert set(np.unique(scene.rejoin())) == {0, 5}


def test_an_object_wider_than_what_hides_it_is_seen_on_both_sides():
    scene = Scene().add(5, line(20, 4.5), range(15), size=40).add(2, line(20, 4.5), range(14, 25), size=40)
    scene.labels[:, :, 100:][scene.labels[:, :, 100:] == 5] = 2
    scene.labels[:, :, :70][scene.labels[:, :, :70] == 2] = 5
    both = [t for t in range(NUM_FRAMES) if {2, 5} <= set(np.unique(scene.labels[t]))]
    assert both
    assert set(np.unique(scene.rejoin())) == {0, 5}


def test_an_object_of_another_colour_is_another():
    scene = hidden(colour=BLUE)
    assert (scene.rejoin() == scene.labels).all()


def test_an_object_of_another_size_is_another():
    scene = hidden(size=36)
    assert (scene.rejoin() == scene.labels).all()


def test_an_object_elsewhere_is_another():
    scene = hidden(path=line(20, 4.5, y=57))
    assert (scene.rejoin() == scene.labels).all()


def test_an_object_that_moves_otherwise_is_another():
    def meeting(velocity0, velocity1):
        """One ends, the other begins six frames later where their mean velocity leads."""
        scene = Scene().add(5, line(16 - 6 * velocity0, velocity0), range(1, 7))
        begin = 16 + 3 * (velocity0 + velocity1)
        return scene.add(2, line(begin - 12 * velocity1, velocity1), range(12, 21)).rejoin()

    assert set(np.unique(meeting(2.0, 2.5))) == {0, 5}
    assert set(np.unique(meeting(1.0, 3.5))) == {0, 2, 5}


def test_an_object_that_left_across_the_border_is_not_rejoined():
    scene = Scene().add(5, line(60, -6), range(12))
    scene.add(2, line(-90, 6), range(16, 25))
    assert (scene.rejoin() == scene.labels).all()


@pytest.mark.parametrize("rows", [slice(25, None), slice(45)])
def test_a_component_that_ends_at_the_border_is_not_rejoined(rows):
    scene = hidden()
    cut = (array[:, rows] for array in (scene.labels, scene.images))
    flows = (array[:, :, rows] for array in (scene.flows, scene.residual))
    assert (rejoin_components(*cut, *flows, PARAMS) == scene.labels[:, rows]).all()


def test_a_gap_is_bounded():
    missing = 16 - 12 - 1
    assert len(np.unique(hidden().rejoin(PARAMS.model_copy(update={"rejoin_gap": missing - 1})))) == 3
    assert len(np.unique(hidden().rejoin(PARAMS.model_copy(update={"rejoin_gap": missing})))) == 2


def test_two_objects_come_out_each_as_itself():
    scene = Scene().add(1, line(20, 4.5, y=20), range(13), RED, 16).add(2, line(20, 4.5, y=48), range(13), BLUE, 16)
    scene.add(3, line(20, 4.5, y=48), range(16, 27), BLUE, 16).add(4, line(20, 4.5, y=20), range(16, 27), RED, 16)
    result = scene.rejoin()
    assert (result[scene.labels == 4] == 1).all()
    assert (result[scene.labels == 3] == 2).all()


def test_one_object_has_one_continuation_and_that_is_the_nearest():
    def rivals(*labels):
        scene = Scene().add(5, line(20, 4.5), range(13))
        for label, y, size in ((2, 27, 20), (7, 45, 14)):
            if label in labels:
                scene.add(label, line(20, 4.5, y), range(16, 27), size=size)
        return scene

    assert set(np.unique(rivals(2).rejoin())) == set(np.unique(rivals(7).rejoin())) == {0, 5}
    both = rivals(2, 7)
    result = both.rejoin()
    assert (result[both.labels == 2] == 5).all()
    assert (result[both.labels == 7] == 7).all()


def test_an_object_hidden_twice_keeps_its_first_label():
    scene = Scene().add(9, line(10, 5), range(1, 27), size=16)
    scene.labels[5:8] = 0
    scene.labels[8:][scene.labels[8:] == 9] = 4
    scene.labels[:, :, 100:][scene.labels[:, :, 100:] > 0] = 1
    assert set(np.unique(scene.labels)) == {0, 1, 4, 9}
    assert set(np.unique(scene.rejoin())) == {0, 9}


def test_same_input_gives_same_labels_and_input_stays():
    scene = hidden()
    before = scene.labels.copy()
    first = scene.rejoin()
    assert (first == scene.rejoin()).all()
    assert first.dtype == before.dtype
    assert (scene.labels == before).all()


def test_no_labels_give_no_labels():
    assert not Scene().rejoin().any()


@pytest.mark.parametrize("wrong", ["images", "flows", "residual flows"])
def test_arrays_of_other_frames_are_refused(wrong):
    scene = hidden()
    arrays = {"images": scene.images, "flows": scene.flows, "residual flows": scene.residual}
    arrays[wrong] = arrays[wrong][1:]
    with pytest.raises(InputError, match=wrong):
        rejoin_components(scene.labels, *arrays.values(), PARAMS)
