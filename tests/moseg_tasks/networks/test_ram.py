import numpy as np
import pytest
import torch

from moseg.tasks.networks.ram import Ram, RamConfig, RamPlus
from moseg.tasks.networks.swin import SwinConfig
from moseg.tasks.networks.swin.block import cut_windows, join_windows, relative_positions, shifted_sight

CONFIG = RamConfig(
    image=SwinConfig(image_size=48, embed_dim=8, depths=(2, 2), num_heads=(2, 4), window_size=3, mlp_ratio=2),
    num_tags=12,
    num_descriptions=3,
    embedding_width=16,
    width=24,
    num_heads=2,
    hidden=48,
)
NETWORKS = [Ram, RamPlus]
# Logits of two images by the official code at these sizes, with the same tensors, in float64.
GOLDEN = {
    Ram: """
        1.715433032 1.019426889 0.968100035 -0.036417136 0.653648641 1.134168277
        0.48934532 1.105790978 1.848979853 0.687286641 -0.006162463 0.012612066
        1.564971485 1.179958465 0.976836973 0.126191998 0.652722907 1.125397771
        0.608181978 1.021529428 1.606844547 0.775008276 0.265929977 0.233674435""",
    RamPlus: """
        0.011551038 -0.2791417 -0.556748422 -0.496579041 -0.417257419 -0.099440759
        -0.491162811 -0.754885446 -0.030166995 -0.703233008 -0.21594899 -0.131925179
        0.204674241 -0.261476098 -0.629285238 -0.628074239 -0.482179172 0.079008996
        -0.223765341 -0.812504549 0.054035444 -0.718497935 -0.05545114 -0.035325431""",
}


def random_network(kind):
    network = kind(CONFIG).double().eval().requires_grad_(False)
    rng = np.random.default_rng(0)
    for name, tensor in sorted(network.state_dict().items()):
        values = torch.from_numpy(np.asarray(rng.standard_normal(tuple(tensor.shape))))
        is_norm = "norm" in name.lower()
        if is_norm or name.endswith("bias"):
            values = 0.1 * values + (is_norm and name.endswith("weight"))
        elif name not in ("label_embed", "reweight_scale"):
            values = values / values[0].numel() ** 0.5
        tensor.copy_(values)
    return network


def random_images(count=2):
    return torch.from_numpy(np.random.default_rng(1).standard_normal((count, 3, 48, 48)))


@pytest.mark.parametrize("kind", NETWORKS)
def test_logits_are_the_official_codes(kind):
    logits = random_network(kind)(random_images())
    assert logits.dtype == torch.float64
    golden = np.array(GOLDEN[kind].split(), np.float64).reshape(2, 12)
    np.testing.assert_allclose(logits.numpy(), golden, rtol=0, atol=2e-9)


@pytest.mark.parametrize("kind", NETWORKS)
def test_an_image_is_tagged_alone_as_in_a_batch(kind):
    network, images = random_network(kind), random_images(3)
    alone = torch.cat([network(image[None]) for image in images])
    np.testing.assert_allclose(network(images).numpy(), alone.numpy(), rtol=0, atol=1e-12)


@pytest.mark.parametrize("kind", NETWORKS)
def test_logits_follow_their_tags_in_the_list(kind):
    network, images = random_network(kind), random_images()
    order = torch.from_numpy(np.random.default_rng(2).permutation(12))
    logits = network(images)
    network.label_embed.copy_(network.label_embed.view(12, -1, 16)[order].view(-1, 16))
    np.testing.assert_allclose(network(images).numpy(), logits[:, order].numpy(), rtol=0, atol=1e-12)


def test_ram_plus_with_like_descriptions_is_ram():
    plus, images = random_network(RamPlus), random_images()
    embeddings = plus.label_embed[::3].clone()
    plus.label_embed.copy_(embeddings.repeat_interleave(3, 0))
    ram = random_network(Ram)
    state = plus.state_dict() | {"label_embed": embeddings}
    del state["reweight_scale"]
    ram.load_state_dict(state)
    np.testing.assert_allclose(plus(images).numpy(), ram(images).numpy(), rtol=0, atol=1e-12)


def test_the_likest_description_alone_counts_at_a_large_scale():
    plus, images = random_network(RamPlus), random_images(1)
    plus.reweight_scale.fill_(20)
    image = plus.image_proj(plus.visual_encoder(images))[0, 0]
    descriptions = plus.label_embed.view(12, 3, 16)
    likest = descriptions[torch.arange(12), (descriptions @ image).argmax(1)]
    logits = plus(images)
    plus.label_embed.copy_(likest.repeat_interleave(3, 0))
    np.testing.assert_allclose(plus(images).numpy(), logits.numpy(), rtol=0, atol=1e-9)


@pytest.mark.parametrize("kind", NETWORKS)
def test_under_autocast_logits_stay_in_float32_and_near(kind, in_half_precision, relative_error):
    network, images = random_network(kind).float(), random_images().float()
    exact = network(images)
    half = in_half_precision(lambda: network(images))
    assert exact.dtype == half.dtype == torch.float32
    assert relative_error(half, exact) < 0.25


def test_windows_are_joined_where_they_were_cut():
    grid = torch.randn(2, 12, 12, 5)
    windows = cut_windows(grid, 4)
    assert windows.shape == (18, 16, 5)
    assert torch.equal(windows[1], grid[0, :4, 4:8].reshape(16, 5))
    assert torch.equal(join_windows(windows, 12), grid)


def test_pairs_of_one_offset_share_their_bias():
    rows = relative_positions(3)
    assert rows.unique().tolist() == list(range(25))
    offset = {}
    for (token0, token1), row in np.ndenumerate(rows.numpy()):
        shift = (token0 // 3 - token1 // 3, token0 % 3 - token1 % 3)
        assert offset.setdefault(int(row), shift) == shift


@pytest.mark.parametrize(("side", "window", "shift"), [(6, 3, 1), (12, 4, 2), (9, 3, 1)])
def test_tokens_of_a_rolled_grid_attend_only_to_former_neighbours(side, window, shift):
    place = torch.arange(side)
    xy = torch.stack(torch.meshgrid(place, place, indexing="ij"), -1)
    rolled = cut_windows(torch.roll(xy, (-shift, -shift), dims=(0, 1))[None], window)
    # Within a window, tokens of two sides of the seam lie further apart than the window is wide.
    is_near = ((rolled[:, :, None] - rolled[:, None]).abs() < window).all(-1)
    assert torch.equal(shifted_sight(side, window, shift)[:, 0], is_near)


@pytest.mark.parametrize(
    "sizes",
    [{"image_size": 50}, {"num_heads": (5, 12, 24, 48)}, {"window_size": 7}, {"depths": (2, 2)}, {"image_size": 36}],
)
def test_sizes_that_do_not_fit_are_refused(sizes):
    with pytest.raises(ValueError, match=r"image_size|stage|depths"):
        SwinConfig(**sizes)
