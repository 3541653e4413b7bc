"""However parameters are spelt, they give the same configuration."""

import pytest

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.workflows.api import load_config
from moseg.workflows.config.config_files import write_config

LENGTH = PipelineConfig.model_validate({"sections": {"length": 20}})


@pytest.mark.parametrize("config", [{"sections.length": 20}, {"sections": {"length": 20}}, LENGTH])
def test_parameters_by_dots_by_stages_and_whole_are_the_same(config):
    assert load_config(config) == LENGTH


def test_a_file_that_was_written_is_read_back(tmp_path):
    path = tmp_path / "config.yaml"
    path.write_text(write_config(LENGTH), encoding="utf-8")
    assert load_config(path) == load_config(str(path)) == LENGTH


def test_parameters_go_on_top_of_a_preset():
    config = load_config({"flow.method": "dis"}, preset="paper", quality="fast")
    assert (config.flow.method, config.depth.method, config.max_side) == ("dis", "dpt-dinov2", 384)


def test_motions_come_before_everything():
    assert load_config({"clustering.motions": 3}).clustering.motions == 3
    assert load_config({"clustering.motions": 3}, motions=2).clustering.motions == 2
    assert load_config(LENGTH, motions="auto").clustering.motions == "auto"
    assert load_config().clustering.motions == "auto"


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"config": LENGTH, "preset": "paper"}, "preset='paper'"),
        ({"config": {"sections.lenght": 3}}, "sections.length"),
        ({"config": {"sections": {"length": 0}}}, "sections.length"),
        ({"config": {"sections": 3}}, "sections"),
        ({"config": "nowhere.yaml"}, "nowhere.yaml"),
        ({"quality": "faster"}, "fast"),
        ({"motions": "many"}, "clustering.motions"),
    ],
)
def test_what_is_wrong_is_told(arguments, says):
    with pytest.raises(InputError, match=says):
        load_config(**arguments)
