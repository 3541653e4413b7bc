import numpy as np
import pytest
import torch

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.ram import RamParams
from moseg.tasks.networks.ram import Ram, RamConfig, Tagger
from moseg.tasks.tags import recognise_tags

CONFIG = RamConfig.model_validate(
    {
        "image": {"image_size": 16, "embed_dim": 4, "depths": [2], "num_heads": [1], "window_size": 2},
        "num_tags": 5,
        "embedding_width": 4,
        "width": 6,
        "num_heads": 2,
        "hidden": 8,
        "num_layers": 1,
    }
)
NAMES = ("person", "car", "dog", "sky", "ball")
IMAGE = np.random.default_rng(0).integers(0, 256, (20, 30, 3), dtype=np.uint8)


class FixedLogits(Ram):
    """Has the given probabilities for every image, and keeps what it was asked about."""

    def __init__(self, probabilities):
        super().__init__(CONFIG)
        self.probabilities = torch.tensor(probabilities)

    def forward(self, images):
        self.images = images
        return torch.logit(self.probabilities)[None]


def fixed_tagger(probabilities=(0.6, 0.9, 0.2, 0.7, 0.6), thresholds=(0.5, 0.95, 0.1, 0.5, 0.5)):
    return Tagger(FixedLogits(probabilities), NAMES, np.array(thresholds))


def random_tagger():
    torch.manual_seed(0)
    network = Ram(CONFIG).eval().requires_grad_(False)
    network.label_embed.normal_()
    return Tagger(network, NAMES, np.zeros(5))


def test_tags_above_their_own_threshold_come_in_the_order_of_the_list():
    tags = recognise_tags(fixed_tagger(), IMAGE, RamParams())
    assert tags.names == ("person", "dog", "sky", "ball")
    assert tags.scores.dtype == np.float64
    np.testing.assert_allclose(tags.scores, [0.6, 0.2, 0.7, 0.6], atol=1e-6)


def test_a_tag_at_its_threshold_does_not_count():
    tagger = fixed_tagger((0.5,) * 5, (0.5, 0.4, 0.5, 0.5, 0.5))
    assert recognise_tags(tagger, IMAGE, RamParams()).names == ("car",)


def test_no_tag_is_an_answer():
    tags = recognise_tags(fixed_tagger(thresholds=(1.0,) * 5), IMAGE, RamParams())
    assert tags.names == () and tags.scores.shape == (0,)


@pytest.mark.parametrize(
    ("params", "names"),
    [
        ({"max_tags": 2}, ("person", "sky")),
        ({"excluded_tags": "sky, ball"}, ("person", "dog")),
        ({"excluded_tags": ("sky",), "max_tags": 1}, ("person",)),
        ({"threshold_scale": 0.9}, ("person", "car", "dog", "sky", "ball")),
        ({"threshold_scale": 1.3}, ("dog", "sky")),
    ],
)
def test_parameters_choose_among_the_tags(params, names):
    assert recognise_tags(fixed_tagger(), IMAGE, RamParams(**params)).names == names


def test_a_tag_that_is_not_of_the_list_cannot_be_left_out():
    with pytest.raises(InputError, match=r"excluded_tags.*Sky"):
        recognise_tags(fixed_tagger(), IMAGE, RamParams(excluded_tags=("Sky", "ball")))


def test_the_frame_is_squeezed_to_the_networks_square_and_normalised():
    tagger = fixed_tagger()
    recognise_tags(tagger, np.full((9, 40, 3), (255, 0, 255), np.uint8), RamParams())
    expected = (np.array([1, 0, 1]) - [0.485, 0.456, 0.406]) / [0.229, 0.224, 0.225]
    assert tagger.network.images.shape == (1, 3, 16, 16)
    np.testing.assert_allclose(tagger.network.images[0].numpy(), np.broadcast_to(expected[:, None, None], (3, 16, 16)))


def test_scores_depend_on_the_frame_and_repeat():
    tagger = random_tagger()
    tags = [recognise_tags(tagger, image, RamParams()) for image in (IMAGE, IMAGE.copy(), 255 - IMAGE)]
    assert tags[0].names == tags[1].names
    np.testing.assert_array_equal(tags[0].scores, tags[1].scores)
    assert not np.array_equal(tags[0].scores, tags[2].scores)


def test_under_autocast_scores_stay_near(in_half_precision, relative_error):
    tagger = random_tagger()
    exact = recognise_tags(tagger, IMAGE, RamParams())
    half = in_half_precision(lambda: recognise_tags(tagger, IMAGE, RamParams()))
    assert half.scores.dtype == np.float64
    # All pass their thresholds of 0; which is first may change.
    by_name = [dict(zip(tags.names, tags.scores, strict=True)) for tags in (half, exact)]
    assert relative_error(*([scores[name] for name in NAMES] for scores in by_name)) < 0.25


@pytest.mark.parametrize("image", [IMAGE[..., 0], IMAGE.astype(np.float32), IMAGE[:0]])
def test_an_array_that_is_not_an_rgb_frame_is_refused(image):
    with pytest.raises(InputError, match="RGB"):
        recognise_tags(fixed_tagger(), image, RamParams())
