"""Parameters as a recipe names them."""

import pytest

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import UnnamedParameterError
from moseg.schemas.frozen import Frozen
from moseg.schemas.parameters import ClusteringParams


def test_only_the_parameters_of_the_recipe_are_read():
    params = ClusteringParams.of_recipe({"grouping": "spectral", "count": {"gap": 2}})
    assert (params.grouping, params.count.gap) == ("spectral", 2)
    with pytest.raises(UnnamedParameterError, match="ClusteringParams; got threshold"):
        _ = params.threshold
    with pytest.raises(UnnamedParameterError, match="MotionCountParams; got num_samples"):
        _ = params.count.num_samples


def test_a_value_equal_to_the_default_is_read_where_it_is_named():
    assert ClusteringParams.of_recipe({"threshold": 0.5}).threshold == 0.5


def test_other_names_are_still_refused_and_no_attribute_is_made_up():
    with pytest.raises(ValueError, match="no_such"):
        ClusteringParams.of_recipe({"no_such": 1})
    with pytest.raises(AttributeError, match="no_such"):
        _ = ClusteringParams().no_such


def _defaults(model, path=()):
    """Yield the path, the default and the class of every nested model of a configuration."""
    for name, field in model.model_fields.items():
        default = field.get_default(call_default_factory=True)
        if isinstance(default, Frozen):
            yield (*path, name), default, type(default)
            yield from _defaults(type(default), (*path, name))


def test_a_parameter_that_is_given_leaves_those_beside_it_at_their_defaults():
    """A default that is no plain instance of its class would be lost as soon as one of its values is given."""
    defaults = [*_defaults(PipelineConfig)]
    assert ("track_groups", "clustering", "energy") in [path for path, _, _ in defaults]
    for path, default, model in defaults:
        assert default == model(), ".".join(path)


def test_a_part_of_the_energy_of_dense_tracks_keeps_the_rest():
    given = {"track_groups": {"clustering": {"energy": {"cut_weight": 0.9}}}}
    default, changed = (
        PipelineConfig.model_validate(values).track_groups.clustering.model_dump() for values in ({}, given)
    )
    assert default["energy"].pop("cut_weight") != changed["energy"].pop("cut_weight") == 0.9
    assert default == changed
    assert default["energy"]["gaps"] != PipelineConfig().trajectory_clustering.energy.gaps
