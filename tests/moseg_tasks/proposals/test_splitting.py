import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.identity import IdentityParams
from moseg.tasks.proposals.splitting import split_touching

PARAMS = IdentityParams()
SHAPE = (80, 160)
NUM_FRAMES = 16


class Scene:
    """Boxes that move over a still background; later ones hide earlier ones. All are one component, label 3."""

    def __init__(self, num_frames=NUM_FRAMES, noise=0.1):
        rng = np.random.default_rng(5)
        self.noise = rng.normal(0, noise, (num_frames, 2, *SHAPE, 2)).astype(np.float32)
        self.noise[0, 0] = self.noise[-1, 1] = 0
        self.velocities = self.noise.copy()
        self.truth = np.zeros((num_frames, *SHAPE), np.uint16)
        self._objects = 0

    def add(self, path, size, to_next=None):
        """A box (height, width) centred on path(t) xy; `to_next(t, x, y)` is its flow, if other than the path's."""
        self._objects += 1
        num_frames = len(self.truth)
        y, x = np.mgrid[: SHAPE[0], : SHAPE[1]]
        for t in range(num_frames):
            centre = np.array(path(t), float)
            inside = (abs(x - centre[0]) < size[1] / 2) & (abs(y - centre[1]) < size[0] / 2)
            self.truth[t][inside] = self._objects
            for direction, other in ((0, t - 1), (1, t + 1)):
                if not 0 <= other < num_frames:
                    continue
                if to_next is None:
                    flow = np.array(path(other), float) - centre
                else:
                    flow = to_next(t, x[inside] - centre[0], y[inside] - centre[1]) * (other - t)
                self.velocities[t, direction][inside] = self.noise[t, direction][inside] + flow
        return self

    @property
    def labels(self):
        return (self.truth > 0).astype(np.uint16) * 3

    def split(self, params=PARAMS):
        return split_touching(self.labels, self.velocities, params)


def crossing(**kwargs) -> Scene:
    """A far box passes behind a nearer and larger one, the other way."""
    scene = Scene(**kwargs)
    scene.add(lambda t: (130 - 6 * t, 36), (24, 30))
    return scene.add(lambda t: (50 + 4 * t, 44), (36, 50))


def share_of_best(labels: np.ndarray, truth: np.ndarray) -> float:
    """Least IoU of a true object with the label that covers most of it."""
    shares = []
    for identity in np.unique(truth[truth > 0]):
        mask = truth == identity
        best = np.bincount(labels[mask]).argmax()
        shares.append((mask & (labels == best)).sum() / (mask | (labels == best)).sum())
    return min(shares)


def test_movers_that_cross_are_two_objects_before_and_after():
    scene = crossing()
    labels = scene.split()
    assert set(np.unique(labels)) == {0, 3, 4}
    assert share_of_best(labels, scene.truth) > 0.9
    assert (labels == 3).sum() > (labels == 4).sum()  # the larger keeps the label


def test_touching_objects_that_move_apart_are_two():
    scene = Scene().add(lambda t: (60 - 2.5 * t, 40), (30, 30)).add(lambda t: (88 + 2.5 * t, 40), (30, 30))
    assert share_of_best(scene.split(), scene.truth) > 0.9


def test_motion_between_frames_several_apart_is_not_the_way_from_each_to_the_next():
    scene = Scene().add(lambda t: (60 - 2.5 * t, 40), (30, 30)).add(lambda t: (88 + 2.5 * t, 40), (30, 30))
    assert (split_touching(scene.labels, scene.velocities, PARAMS, gap=1) != scene.labels).any()
    assert (split_touching(scene.labels, scene.velocities, PARAMS, gap=2) == scene.labels).all()


def test_three_movers_in_one_component_are_three():
    scene = Scene(num_frames=12).add(lambda t: (50 - 3 * t, 40), (30, 30)).add(lambda t: (78 + 3 * t, 40), (30, 30))
    scene.add(lambda t: (64, 28 + 3 * t), (16, 16))
    labels = scene.split()
    assert len(np.unique(labels)) == 4
    assert share_of_best(labels, scene.truth) > 0.75


def test_parts_are_bounded():
    scene = Scene(num_frames=12).add(lambda t: (50 - 3 * t, 40), (30, 30)).add(lambda t: (78 + 3 * t, 40), (30, 30))
    scene.add(lambda t: (64, 28 + 3 * t), (16, 16))
    assert len(np.unique(scene.split(PARAMS.model_copy(update={"split_parts": 2})))) == 3
    assert (scene.split(PARAMS.model_copy(update={"split_parts": 1})) == scene.labels).all()


def test_movers_with_one_velocity_stay_together():
    scene = Scene().add(lambda t: (60 + 3 * t, 40), (30, 30)).add(lambda t: (88 + 3 * t, 30), (30, 30))
    assert (scene.split() == scene.labels).all()


def test_a_limb_that_swings_is_no_object():
    def swing(t):
        return 12 * np.sin(2 * np.pi * t / 10)

    scene = Scene(num_frames=20).add(lambda t: (40 + 3 * t, 30), (30, 30))
    scene.add(lambda t: (40 + 3 * t + swing(t), 54), (24, 12))
    assert (scene.split() == scene.labels).all()


def test_a_pendulum_is_one_object():
    def turning(t, x, y):
        rate = 0.25 * np.cos(2 * np.pi * t / 12)
        return np.stack([2 - rate * (y + 25), rate * x], axis=-1)

    scene = Scene().add(lambda t: (60 + 2 * t, 20), (20, 20)).add(lambda t: (60 + 2 * t, 50), (50, 14), turning)
    assert (scene.split() == scene.labels).all()


def test_an_object_that_turns_or_grows_is_one():
    def growing(t, x, y):
        return np.stack([0.08 * x - 0.05 * y + 3, 0.08 * y + 0.05 * x], axis=-1)

    scene = Scene().add(lambda t: (60 + 3 * t, 40), (50, 70), growing)
    assert (scene.split() == scene.labels).all()


def test_specks_and_noise_are_no_objects():
    noisy = Scene(noise=1.5).add(lambda t: (60 + 3 * t, 40), (40, 50))
    assert (noisy.split() == noisy.labels).all()
    speck = Scene().add(lambda t: (60 + 3 * t, 40), (40, 50)).add(lambda t: (80 - 2 * t, 40), (3, 3))
    assert (speck.split() == speck.labels).all()


def test_motions_that_spread_as_much_as_they_differ_are_one():
    assert len(np.unique(crossing(noise=1.0).split())) == 3
    scene = crossing(noise=2.0)
    assert (scene.split() == scene.labels).all()


def test_motions_that_interleave_are_no_objects():
    scene = Scene(num_frames=10)
    for stripe in range(4):
        velocity = 4 * (-1) ** stripe
        scene.add(lambda t, x=80 - 4.5 * velocity, y=20 + 12 * stripe, v=velocity: (x + v * t, y), (13, 60))
    assert (scene.split() == scene.labels).all()


def test_specks_within_an_object_are_its_own():
    scene = crossing()
    y, x = 50, 58
    scene.velocities[2, :, y : y + 5, x : x + 5] *= -1.5
    labels = scene.split()
    assert set(np.unique(labels)) == {0, 3, 4}
    assert (labels[2, y - 5 : y + 10, x - 5 : x + 10] == 3).all()


def test_a_short_encounter_splits_nothing():
    scene = crossing(num_frames=PARAMS.split_frames - 1)
    assert (scene.split() == scene.labels).all()


def test_frames_shown_twice_do_not_matter():
    scene = crossing()
    scene.velocities[4] = 0
    labels = scene.split()
    assert set(np.unique(labels)) == {0, 3, 4}
    others = np.arange(NUM_FRAMES) != 4
    assert share_of_best(labels[others], scene.truth[others]) > 0.9


def test_components_are_split_each_for_itself_and_background_stays():
    scene = crossing()
    labels = scene.labels
    labels[:, 70:78, 5:15] = 1
    result = split_touching(labels, scene.velocities, PARAMS)
    assert ((result == 1) == (labels == 1)).all()
    assert ((result == 0) == (labels == 0)).all()
    assert result.dtype == labels.dtype


def test_same_input_gives_same_labels_and_input_stays():
    scene = crossing()
    labels, before = scene.labels, scene.labels.copy()
    first = split_touching(labels, scene.velocities, PARAMS)
    assert (first == split_touching(labels.astype(np.int32), scene.velocities, PARAMS)).all()
    assert (labels == before).all()


def test_no_labels_give_no_labels():
    scene = Scene(num_frames=3)
    assert not scene.split().any()


def test_flows_of_another_size_are_refused():
    with pytest.raises(InputError, match="flows are not those of the labels"):
        split_touching(np.zeros((4, 5, 6), np.uint16), np.zeros((4, 2, 6, 5, 2), np.float32), PARAMS)
