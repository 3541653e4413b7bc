"""The seal of the manifest file."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.digests import digest_bytes
from moseg.schemas.manifests import Manifest
from moseg.schemas.recipes import Recipe
from moseg.store.sealing import digest_metadata, seal, unseal

JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=6,
)


def manifest(attributes: dict | None = None) -> Manifest:
    recipe = Recipe(task="toy", version=1)
    return Manifest(
        key=recipe.key,
        recipe=recipe,
        arrays=(),
        attributes=attributes or {},
        seconds=0.5,
        nbytes=0,
        created="2024-01-01T00:00:00+00:00",
        host="here",
        versions={},
    )


@settings(max_examples=60, deadline=None)
@given(attributes=st.dictionaries(st.text(max_size=5), JSON, max_size=3))
def test_unseal_returns_the_manifest_to_the_last_digit(attributes):
    found = unseal(seal(manifest(attributes), {})).manifest
    assert found == manifest(attributes)
    assert repr(found.attributes) == repr(attributes)


def test_seal_names_the_metadata_files():
    sealed = unseal(seal(manifest(), {"zarr.json": digest_metadata(b"{}")}))
    assert sealed.metadata == {"zarr.json": digest_metadata(b"{}")}


@pytest.mark.parametrize(
    "change", [lambda d: d + b"\n", lambda d: d[:-1], lambda d: b"", lambda d: d.replace(b" ", b"")]
)
def test_any_other_bytes_are_refused(change):
    data = seal(manifest({"note": "a b"}), {})
    with pytest.raises(ValueError, match="seal"):
        unseal(change(data))


def test_a_sealed_manifest_with_other_fields_is_refused():
    content = seal(manifest(), {})[len(b'{"seal":"') + 64 + len(b'","content":') : -2].replace(b'"host"', b'"hosts"')
    seal_of_it = digest_bytes("seal", content).encode()
    with pytest.raises(ValueError, match="format"):
        unseal(b'{"seal":"' + seal_of_it + b'","content":' + content + b"}\n")
