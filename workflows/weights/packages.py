"""The libraries that networks run on; without networks nothing needs them."""

from importlib.util import find_spec

from moseg.schemas.errors import InputError

PACKAGES = ("torch", "transformers", "safetensors")


def require_network_packages() -> None:
    """Raise InputError, with the command that installs them, where a library that networks need is missing here."""
    missing = [name for name in PACKAGES if find_spec(name) is None]
    if missing:
        expected = "pip install 'moseg[models]'"
        raise InputError(f"networks need {' and '.join(missing)}", got="not installed", expected=expected)
