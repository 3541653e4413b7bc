"""Qualities: trade-offs between accuracy and time, on top of any preset."""

import numpy as np
import pytest

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.schemas.parameters import FlowParams
from moseg.schemas.presets import GEOMETRIES, PRESETS, QUALITIES
from moseg.tasks.flow import estimate_flow
from moseg.workflows.cli.pipeline_options import PipelineOptions
from moseg.workflows.config.pipeline_choices import choose_preset


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("geometry", GEOMETRIES)
@pytest.mark.parametrize("quality", QUALITIES)
def test_every_combination_is_a_configuration(preset, geometry, quality):
    PipelineConfig.model_validate(choose_preset(preset, geometry, quality))


def test_the_default_quality_changes_nothing():
    assert PipelineOptions(quality="default").choices().read() == PipelineOptions().choices().read()


def test_fast_reduces_frames_and_a_setting_overrides_it():
    config = PipelineOptions(quality="fast").choices().read()
    assert (config.max_side, config.saliency.working_side) == (384, 192)
    config = PipelineOptions(quality="fast", settings=["saliency.working_side=300"]).choices().read()
    assert (config.max_side, config.saliency.working_side) == (384, 300)


def test_best_looks_closer_and_needs_no_torch():
    config, default = PipelineOptions(quality="best").choices().read(), PipelineConfig()
    assert config.saliency.working_side > default.saliency.working_side
    assert config.motion_network.step < default.motion_network.step
    assert config.video_network.use == "never"


def test_a_quality_keeps_the_backend_of_a_preset():
    config = PipelineOptions(preset="paper", quality="best").choices().read()
    assert (config.flow.method, config.flow.preset) == ("raft", "fine")


def test_an_unknown_quality_is_reported_with_a_suggestion():
    with pytest.raises(InputError, match="best"):
        PipelineOptions(quality="bset").choices().read()


def test_an_unknown_quality_ends_in_one_line(moseg):
    ran = moseg("eval", "--quality", "perfect")
    assert ran.code == 2 and ran.err.count("\n") == 1 and "--quality" in ran.err


@pytest.mark.parametrize("side", [20, 96])
def test_fine_flow_finds_a_known_shift_and_differs_from_medium(side):
    rng = np.random.default_rng(4)
    coarse = rng.integers(0, 256, (side // 4 + 4, side // 4 + 4, 3), dtype=np.uint8)
    scene = np.kron(coarse, np.ones((4, 4, 1), np.uint8))
    image0, image1 = scene[4 : 4 + side, 4 : 4 + side], scene[4 : 4 + side, 2 : 2 + side]
    params = (FlowParams(preset=preset, search_side=16) for preset in ("fine", "medium"))
    fine, medium = (estimate_flow(image0, image1, each) for each in params)
    assert fine.shape == (side, side, 2) and np.isfinite(fine).all()
    assert not np.array_equal(fine, medium)
    if side > 32:
        np.testing.assert_allclose(np.median(fine, axis=(0, 1)), [2, 0], atol=0.1)
