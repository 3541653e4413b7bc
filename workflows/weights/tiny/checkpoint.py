"""Files of a tiny checkpoint."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from transformers import PreTrainedModel


class TinyCheckpoint(NamedTuple):
    """Files by name, in the published network's format, and the sizes in which our module differs from it."""

    files: dict[str, bytes]
    config: dict[str, Any] = {}


def save_to_bytes(model: "PreTrainedModel") -> dict[str, bytes]:
    """Return ``config.json`` and ``model.safetensors`` as transformers writes them, with published tensor names."""
    from moseg.tasks.networks.transformers_model import quiet_transformers

    with TemporaryDirectory() as folder, quiet_transformers():
        model.save_pretrained(folder)
        return {name: Path(folder, name).read_bytes() for name in ("config.json", "model.safetensors")}
