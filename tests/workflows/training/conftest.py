"""A training small enough for a test: three rendered scenes, two textures."""

import pytest

TINY = {"scenes": 2, "validation_scenes": 1, "textures": 2, "steps": 4, "batch": 2, "interval": 2, "warm_up": 1}


@pytest.fixture(scope="session")
def scene_files(tmp_path_factory):
    """Return a folder of a training with its scenes drawn."""
    from moseg.schemas.parameters import NetworkTrainingParams
    from moseg.workflows.training.drawing import draw_shards
    from moseg.workflows.training.rendered_scenes import scene_shards, validation_shards

    folder, params = tmp_path_factory.mktemp("training"), NetworkTrainingParams(**TINY)
    draw_shards([*scene_shards(folder, params, 0), *validation_shards(folder, params, 0)], 1, quiet=True)
    return folder


@pytest.fixture
def options(scene_files):
    """Return the options of `moseg train` for the tiny training, without its folder."""
    settings = [f"--set={name}={value}" for name, value in TINY.items()]
    return ["train", *settings, "--workers", "1", "--threads", "1", "--device", "cpu", "--quiet"]


@pytest.fixture(scope="session")
def start(tmp_path_factory):
    """Return the file of a network with random weights."""
    import torch

    from moseg.tasks.motion_network.export import to_onnx
    from moseg.tasks.motion_network.unet import MotionUNet

    torch.manual_seed(0)
    path = tmp_path_factory.mktemp("start") / "start.onnx"
    path.write_bytes(to_onnx(MotionUNet().eval()))
    return path
