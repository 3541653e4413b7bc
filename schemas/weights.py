"""Weights of networks: the files of an item, their sources and licence."""

import re
from typing import Annotated, Any
from urllib.parse import urlsplit

from pydantic import AfterValidator, Field, StringConstraints, field_validator, model_validator

from moseg.schemas.choices import ChoiceOf
from moseg.schemas.declared_names import declared_names
from moseg.schemas.digests import canonical_json
from moseg.schemas.frozen import Frozen

Architecture = Annotated[str, ChoiceOf("weights.architecture")]
"""Of a network; the stages declare those that they run."""
TENSOR_SUFFIXES = (".pth", ".bin", ".safetensors")
PINS = "pins.json"
RESERVED = (PINS, ".lock")
RESERVED_SUFFIXES = (".partial", ".refused")
LOOPBACK = ("localhost", "127.0.0.1", "::1")


def documents_of(architecture: str) -> tuple[str, ...]:
    """Return the files from which a network is built, in addition to its tensors."""
    return declared_names(f"weights.documents.{architecture}")


def is_trusted_url(url: str) -> bool:
    """Return whether downloads from an address are safe from changes in transit: ``https``, or this machine.

    Invalid addresses are not trusted either: a valid one is printable ASCII without blanks, with a valid host name and
    port number.
    """
    if not re.fullmatch(r"[!-~]+", url):
        return False
    try:
        parts = urlsplit(url)
        (parts.hostname or "").encode("idna")
        _ = parts.port
    except ValueError:
        return False
    return (parts.scheme == "https" and bool(parts.hostname)) or (parts.scheme == "http" and parts.hostname in LOOPBACK)


def _check_url(url: str) -> str:
    if not is_trusted_url(url):
        raise ValueError("Input should be an https:// address in printable ASCII")
    return url


Name = Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9][A-Za-z0-9._+-]{0,99}$")]
"""Name of a single folder or file: no separators, no leading dot."""
Sha256 = Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")]


class WeightsFile(Frozen):
    """One file of an item, with its name on this machine."""

    name: Name
    url: Annotated[str, AfterValidator(_check_url)] | None = Field(None, description="none: the user provides the file")
    size: int | None = Field(None, ge=1, description="bytes")
    sha256: Sha256 | None = Field(None, description="none: the existing file is accepted, or the first download")

    @field_validator("name")
    @classmethod
    def _check_name(cls, name: str) -> str:
        if name in RESERVED or name.endswith(RESERVED_SUFFIXES):
            raise ValueError("Input should be a name that the folder of weights does not use itself")
        return name

    @property
    def is_fixed_by_download(self) -> bool:
        """Return whether the item states the file's address but not its digest: its first download fixes it."""
        return self.url is not None and self.sha256 is None


class WeightsItem(Frozen):
    """The weights of one network."""

    name: Name
    architecture: Architecture
    licence: str = Field("not stated", description="SPDX identifier of the weights' licence")
    is_non_commercial: bool = False
    has_conditions: bool = Field(
        False, description="the licence restricts the use otherwise; it is accepted by its name"
    )
    files: tuple[WeightsFile, ...]
    config: dict[str, Any] = Field(
        {}, description="values that its files do not contain: sizes of own modules, a range of depths"
    )
    homepage: str = ""
    approximate_size: int | None = Field(None, ge=0, description="bytes, if the files' exact sizes are not known")

    @field_validator("config")
    @classmethod
    def _check_config(cls, config: dict[str, Any]) -> dict[str, Any]:
        try:
            canonical_json(config)
        except TypeError as error:
            raise ValueError(str(error)) from error
        return config

    @model_validator(mode="after")
    def _check_files(self) -> "WeightsItem":
        names = [file.name for file in self.files]
        tensors = [name for name in names if name.endswith(TENSOR_SUFFIXES)]
        if len(tensors) != 1 or len(set(names)) != len(names):
            raise ValueError(
                f"Input should be files of different names, exactly one of them {_either(TENSOR_SUFFIXES)}"
            )
        absent = [name for name in documents_of(self.architecture) if name not in names]
        if absent:
            raise ValueError(f"Input should be an item whose files include {', '.join(absent)}")
        return self

    @property
    def consent(self) -> str:
        """Return the option by which a user accepts the licence; empty if it allows any use."""
        if self.is_non_commercial:
            return "--non-commercial"
        return f"--accept-licence {self.licence}" if self.has_conditions else ""

    @property
    def size(self) -> int | None:
        """Return the bytes of the files, small ones as far as known; None if the size of the tensors is unknown."""
        tensors = next(file for file in self.files if file.name.endswith(TENSOR_SUFFIXES))
        return self.approximate_size if tensors.size is None else sum(file.size or 0 for file in self.files)


class WeightsList(Frozen):
    """Items of a user: they extend the catalogue, or replace its items of the same name."""

    items: tuple[WeightsItem, ...]

    @field_validator("items")
    @classmethod
    def _check_names(cls, items: tuple[WeightsItem, ...]) -> tuple[WeightsItem, ...]:
        if len({item.name for item in items}) != len(items):
            raise ValueError("Input should be items of different names")
        return items


def _either(names: tuple[str, ...]) -> str:
    return f"{', '.join(names[:-1])} or {names[-1]}"
