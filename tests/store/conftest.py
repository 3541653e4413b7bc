"""A fresh store, and toy artifacts whose task has no layout in the schemas."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from schemas.recipes import Recipe
from store import LocalStore


@pytest.fixture
def store(tmp_path: Path) -> LocalStore:
    return LocalStore(tmp_path / "store")


@pytest.fixture
def put_toy() -> Callable[..., str]:
    """Put an artifact of task ``toy`` with one array ``x`` and return its reference."""

    def put(target, number: int = 0, inputs: dict | None = None, array: np.ndarray | None = None) -> str:
        recipe = Recipe(task="toy", version=1, params={"number": number}, inputs=inputs or {})
        array = np.arange(6.0).reshape(2, 3) + number if array is None else array
        target.put(recipe, {"x": array}, dims={"x": tuple("abcdef"[: array.ndim])})
        return recipe.ref

    return put
