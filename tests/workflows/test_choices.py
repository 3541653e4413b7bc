"""Presets of networks and of geometry: the parameters that each sets, without overlap."""

import pytest

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.schemas.presets import GEOMETRIES, PRESETS
from moseg.workflows.cli.pipeline_options import PipelineOptions
from moseg.workflows.config.parameters import list_parameters, value_of


def test_presets_and_geometries_set_different_stages():
    assert not {stage for preset in PRESETS.values() for stage in preset} & {
        stage for geometry in GEOMETRIES.values() for stage in geometry
    }


def test_without_a_choice_the_configuration_is_the_default():
    assert PipelineOptions().choices().read() == PipelineConfig()


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_every_preset_can_be_combined_with_every_geometry(preset, geometry):
    config = PipelineOptions(preset=preset, geometry=geometry).choices().read()
    assert (config.affinity.method == "ork") == (geometry == "paper")
    assert (config.proposal_source == "detections") == (preset != "weights-free")


def test_an_option_changes_one_choice_of_a_preset():
    config = PipelineOptions(preset="paper", flow="dis", settings=["pips.iterations=3"]).choices().read()
    paper = PipelineOptions(preset="paper").choices().read()
    changed = {name for name in PipelineConfig.model_fields if getattr(config, name) != getattr(paper, name)}
    assert changed == {"flow", "pips"}


def test_a_sensitivity_is_one_of_proposals_from_tracks():
    for proposals in (None, "auto", "tracks"):
        config = PipelineOptions(proposals=proposals, sensitivity=2.5).choices().read()
        assert config.track_objects.sensitivity == 2.5
    with pytest.raises(InputError, match="an option of tracks in --sensitivity"):
        PipelineOptions(proposals="saliency", sensitivity=2.5).choices().read()


def test_one_parameter_of_a_stage_within_a_stage_leaves_the_others_as_they_are():
    config = PipelineOptions(proposals="tracks", settings=["track_groups.kernel.window=0.2"]).choices().read()
    default = PipelineConfig().track_groups.kernel
    assert config.track_groups.kernel == default.model_copy(update={"window": 0.2})
    for name, parameter in list_parameters().items():
        assert value_of(PipelineConfig(), parameter) == parameter.default, name


@pytest.mark.parametrize("command", ["segment", "eval", "ablate", "plan", "contact-sheet"])
def test_commands_offer_the_sensitivity(moseg, command):
    assert "--sensitivity" in moseg(command, "--help").out


def test_ranks_that_do_not_determine_the_number_of_motions_are_reported(evaluated_copy, moseg):
    ran = moseg(*evaluated_copy.arguments, "--store", evaluated_copy.store, "--geometry", "paper")
    assert ran.code == 0 and "give it by --motions" in ran.out
    ran = moseg(*evaluated_copy.arguments, "--store", evaluated_copy.store, "--geometry", "paper", "--motions", "gt")
    assert ran.code == 0 and "give it by --motions" not in ran.out
