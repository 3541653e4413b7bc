"""The folder of weights, and the items that a user adds there."""

import os
from collections.abc import Mapping
from pathlib import Path

from pydantic import ValidationError

from moseg.schemas.errors import InputError
from moseg.schemas.weights import WeightsItem, WeightsList

FOLDER_VARIABLE = "MOSEG_WEIGHTS"
OWN_ITEMS = "weights.json"


def weights_folder(env: Mapping[str, str]) -> Path:
    """Return ``$MOSEG_WEIGHTS``, else ``moseg/weights`` in the user's cache."""
    if env.get(FOLDER_VARIABLE):
        return Path(os.path.abspath(os.path.expanduser(env[FOLDER_VARIABLE])))
    cache = env.get("XDG_CACHE_HOME") or os.path.join(env.get("HOME") or os.path.expanduser("~"), ".cache")
    return Path(os.path.abspath(cache)) / "moseg" / "weights"


def read_own_items(folder: Path) -> tuple[WeightsItem, ...]:
    """Return the items that ``weights.json`` in the folder of weights describes; none if there is no such file.

    Raises
    ------
    InputError
        The file cannot be read, or an item in it is not valid.
    """
    path = folder / OWN_ITEMS
    try:
        return WeightsList.model_validate_json(path.read_bytes()).items
    except FileNotFoundError:
        return ()
    except OSError as error:
        raise InputError("unreadable file", where=path, got=error.strerror) from error
    except ValidationError as error:
        problem = error.errors()[0]
        place = ".".join(str(part) for part in problem["loc"]) or "JSON"
        message = problem["msg"].removeprefix("Value error, ").removeprefix("Input should be ")
        raise InputError(
            "bad weights item", where=f"{path} at {place:.200}", got=_short(problem["input"]), expected=message
        ) from error


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
