"""The manifest file: a manifest under a seal that any changed byte breaks.

Chunks have checksums and arrays have digests; the manifest that names them and Zarr's own metadata files would have
none. So the file holds the digests of the metadata files beside the manifest, and the digest of both in front. Every
byte is checked: bytes outside the sealed content are compared literally.
"""

from collections.abc import Mapping

from pydantic import ValidationError

from moseg.schemas.digests import digest_bytes
from moseg.schemas.frozen import Frozen
from moseg.schemas.manifests import Manifest
from moseg.store.packing import PACK, pack_nbytes

_BEFORE, _BETWEEN, _AFTER = b'{"seal":"', b'","content":', b"}\n"
_SEAL_LENGTH = 64


class Sealed(Frozen):
    """A manifest, the digest of each metadata file by relative path, and the place of the files.

    Attributes
    ----------
    payload : str
        Name of the place of the artifact's files, on a backend where there may be several for one key; empty if they
        lie beside the manifest.
    is_packed : bool
        Whether the files are in one pack.
    """

    metadata: dict[str, str]
    manifest: Manifest
    payload: str = ""
    is_packed: bool = False

    def stored_sizes(self) -> dict[str, int]:
        """Return the bytes of each file that the backend holds beside the manifest, by relative path."""
        if self.is_packed:
            return {PACK: pack_nbytes(self.manifest.files)}
        return {file.path: file.nbytes for file in self.manifest.files}


def seal(manifest: Manifest, metadata: Mapping[str, str], payload: str = "", is_packed: bool = False) -> bytes:
    """Return the content of the manifest file; `metadata` are the digests of the metadata files by relative path."""
    sealed = Sealed(metadata=dict(metadata), manifest=manifest, payload=payload, is_packed=is_packed)
    # the manifest of separate files beside it keeps the format of before there were other places and packs
    plain = {name for name in ("payload", "is_packed") if not getattr(sealed, name)}
    content = sealed.model_dump_json(exclude=plain).encode("utf-8")
    return _BEFORE + _digest(content) + _BETWEEN + content + _AFTER


def unseal(data: bytes) -> Sealed:
    """Return the manifest in a manifest file; raises ValueError if a byte differs from what was sealed."""
    start = len(_BEFORE) + _SEAL_LENGTH
    content = data[start + len(_BETWEEN) : -len(_AFTER)]
    if data != _BEFORE + _digest(content) + _BETWEEN + content + _AFTER:
        raise ValueError("the manifest's seal is broken")
    try:
        return Sealed.model_validate_json(content)
    except ValidationError as error:
        raise ValueError(f"the manifest is not of this format: {error.error_count()} wrong fields") from None


def digest_metadata(content: bytes | memoryview) -> str:
    """Return the digest of one of Zarr's metadata files."""
    return digest_bytes("metadata", content)


def _digest(content: bytes) -> bytes:
    return digest_bytes("seal", content).encode("ascii")
