"""Parameters as a recipe names them."""

import pytest

from moseg.schemas.errors import UnnamedParameterError
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
