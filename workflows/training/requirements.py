"""Packages that training needs beyond those of the default installation."""

from importlib import import_module

from moseg.schemas.errors import InputError


def require_packages() -> None:
    """Raise InputError unless torch and onnx can be imported."""
    for name in ("torch", "onnx"):
        try:
            import_module(name)
        except ImportError as error:
            expected = "pip install 'moseg[models]'"
            raise InputError(f"training needs {name}", where="moseg train", got=error, expected=expected) from error
