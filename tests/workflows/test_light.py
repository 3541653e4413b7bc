"""`--light`: the lighter networks of a preset."""

import pytest

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant
from moseg.schemas.errors import InputError
from moseg.schemas.presets import GEOMETRIES, LIGHT, PRESETS, QUALITIES
from moseg.workflows.api.configuration import load_config
from moseg.workflows.cli.pipeline_options import PipelineOptions
from moseg.workflows.config.pipeline_choices import PipelineChoices, choose_preset
from moseg.workflows.config.trajectory_choices import TrajectoryChoices
from moseg.workflows.stages.merits import sum_costs
from moseg.workflows.stages.needed_weights import needed_items
from moseg.workflows.weights.catalogue import CATALOGUE


def _items(preset, light):
    return set(needed_items(PipelineConfig.model_validate(choose_preset(preset, light=light))))


@pytest.mark.parametrize("preset", LIGHT)
@pytest.mark.parametrize("quality", QUALITIES)
@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_every_light_preset_is_a_configuration_with_every_quality_and_geometry(preset, quality, geometry):
    PipelineConfig.model_validate(choose_preset(preset, geometry, quality, light=True))


@pytest.mark.parametrize("preset", LIGHT)
def test_a_light_preset_differs_only_where_its_table_says(preset):
    plain, light = (PipelineConfig.model_validate(choose_preset(preset, light=way)) for way in (False, True))
    changed = {name for name in PipelineConfig.model_fields if getattr(plain, name) != getattr(light, name)}
    assert changed == set(LIGHT[preset])


def test_weights_of_the_light_modern_preset_may_be_used_for_anything():
    free = {item.name for item in CATALOGUE if not item.consent}
    assert _items("modern", True) <= free and _items("modern", True) != _items("modern", False)


@pytest.mark.parametrize("source", ["detections", "motion-prompts"])
def test_light_networks_take_at_most_two_seconds_a_frame_on_four_cores(source):
    config = PipelineChoices(preset="modern", light=True, settings=(("proposal_source", source),)).make_config()
    found = sum_costs(config, light=True)
    assert found.seconds / 4 <= 2 and not found.unmeasured


@pytest.mark.parametrize("source", ["motion-prompts", "sam3"])
def test_a_source_of_proposals_keeps_the_light_tracker_unless_another_is_chosen(source):
    settings = (("proposal_source", source),)
    light = PipelineChoices(preset="modern", light=True, settings=settings).make_config()
    assert light.detections.tracker == "deaot" and light.detections.masks == "sam2"
    chosen = (*settings, ("detections.tracker", "edgetam"))
    assert PipelineChoices(preset="modern", light=True, settings=chosen).make_config().detections.tracker == "edgetam"


@pytest.mark.parametrize("preset", sorted(PRESETS.keys() - LIGHT.keys()))
def test_a_preset_without_lighter_networks_is_an_input_error(preset):
    with pytest.raises(InputError, match=f"--light; got {preset}; expected --preset modern"):
        PipelineOptions(preset=preset, light=True).choices().read()


def test_a_setting_overrides_what_is_light():
    config = PipelineOptions(preset="modern", light=True, settings=["sea_raft.weights=sea-raft-m"]).choices().read()
    assert config.sea_raft.weights == "sea-raft-m" and config.sam2.weights == "sam2.1-hiera-tiny"


def test_python_and_the_command_line_agree():
    assert load_config(preset="modern", light=True) == PipelineOptions(preset="modern", light=True).choices().read()
    with pytest.raises(InputError, match="light"):
        load_config(preset="modern", light="yes")


def test_a_whole_configuration_allows_no_light_beside_it():
    with pytest.raises(InputError, match="a whole configuration beside a choice"):
        load_config(PipelineConfig(), light=True)


@pytest.mark.parametrize("arguments", [("eval", "--light"), ("weights", "fetch", "--light")])
def test_light_without_its_preset_ends_in_one_line(moseg, arguments):
    ran = moseg(*arguments)
    assert ran.code == 2 and ran.err.count("\n") == 1 and "--light" in ran.err and "--preset modern" in ran.err


def test_trajectories_have_no_lighter_networks():
    with pytest.raises(InputError, match="an option for images in --light"):
        TrajectoryChoices().apply(PipelineChoices(light=True), PipelineConfig(), "kt3dmoseg", TrajectoryVariant)


def test_tiny_checkpoints_include_those_of_the_light_preset(moseg, tmp_path):
    assert moseg("weights", "tiny", tmp_path / "tiny").code == 0
    assert {folder.name for folder in (tmp_path / "tiny").iterdir() if folder.is_dir()} >= _items("modern", True)
