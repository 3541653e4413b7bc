"""Presets of networks and of geometry: the parameters that each sets, without overlap."""

import pytest

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.presets import GEOMETRIES, PRESETS
from moseg.workflows.cli.pipeline_options import PipelineOptions


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


def test_ranks_that_do_not_determine_the_number_of_motions_are_reported(evaluated_copy, moseg):
    ran = moseg(*evaluated_copy.arguments, "--store", evaluated_copy.store, "--geometry", "paper")
    assert ran.code == 0 and "give it by --motions" in ran.out
    ran = moseg(*evaluated_copy.arguments, "--store", evaluated_copy.store, "--geometry", "paper", "--motions", "gt")
    assert ran.code == 0 and "give it by --motions" not in ran.out
