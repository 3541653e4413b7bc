"""From the names of a preset, a geometry and a quality to values of parameters."""

from collections.abc import Mapping
from typing import Any

from moseg.schemas.presets import GEOMETRIES, PRESETS, QUALITIES
from moseg.schemas.spelling import unknown_name


def choose_preset(preset: str = "weights-free", geometry: str = "default", quality: str = "default") -> dict[str, Any]:
    """Values of a preset, a geometry and a quality; raises InputError where there is none of the name."""
    options = (("--preset", preset, PRESETS), ("--geometry", geometry, GEOMETRIES), ("--quality", quality, QUALITIES))
    values: dict[str, Any] = {}
    for option, name, known in options:
        if name not in known:
            raise unknown_name(option.removeprefix("--"), name, known, where=option)
        for stage, chosen in known[name].items():
            values[stage] = {**values.get(stage, {}), **chosen} if isinstance(chosen, Mapping) else chosen
    return values
