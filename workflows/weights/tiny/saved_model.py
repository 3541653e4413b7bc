"""The files of a model of transformers."""

from pathlib import Path
from tempfile import TemporaryDirectory

from transformers import PreTrainedModel

from moseg.tasks.networks.transformers_model import quiet_transformers


def save_to_bytes(model: PreTrainedModel) -> dict[str, bytes]:
    """``config.json`` and ``model.safetensors`` as transformers writes them, with the published names of tensors."""
    with TemporaryDirectory() as folder, quiet_transformers():
        model.save_pretrained(folder)
        return {name: Path(folder, name).read_bytes() for name in ("config.json", "model.safetensors")}
