"""Properties of every item of the catalogue."""

import pytest

from moseg.schemas.declared_names import declared_names
from moseg.schemas.weights import TENSOR_SUFFIXES
from moseg.workflows.weights.catalogue import CATALOGUE
from moseg.workflows.weights.hub import parse_hub_url

ITEMS = {item.name: item for item in CATALOGUE}


def test_every_architecture_has_weights():
    assert {item.architecture for item in CATALOGUE} == set(declared_names("weights.architecture"))
    assert len(ITEMS) == len(CATALOGUE)


@pytest.mark.parametrize("name", ITEMS)
def test_every_file_has_an_https_address(name):
    assert all(file.url.startswith("https://") for file in ITEMS[name].files)


@pytest.mark.parametrize("name", ITEMS)
def test_every_item_states_licence_size_and_homepage(name):
    item = ITEMS[name]
    assert item.licence in ("Apache-2.0", "BSD-3-Clause", "MIT", "CC-BY-NC-4.0", "SAM-License")
    assert item.is_non_commercial == (item.licence == "CC-BY-NC-4.0")
    assert item.has_conditions == (item.licence == "SAM-License")
    assert item.size > 10**6
    assert item.homepage.startswith("https://")


def test_torchvision_names_its_files_by_their_digests():
    for name in ("raft-large", "raft-small"):
        file = ITEMS[name].files[0]
        assert file.url.endswith(f"-{file.sha256[:8]}.pth")


def test_only_these_items_lie_at_neither_a_digest_nor_a_commit():
    unpinned = set()
    for item in CATALOGUE:
        for file in item.files:
            hub = parse_hub_url(file.url)
            if file.sha256 is None and not (hub is not None and hub.is_pinned):
                unpinned.add(item.name)
    assert unpinned == {"edgetam", "pips", "sam-hq-vit-base", "sam-hq-vit-large", "sea-raft-s"}


def test_items_of_one_repository_keep_its_names_but_for_tensors():
    for item in CATALOGUE:
        for file in item.files:
            remote = file.url.rpartition("/")[2]
            assert file.name == remote or file.name.startswith("model.") or file.name in ("tags.txt", "thresholds.txt")
            assert not file.name.startswith("model.") or file.name.endswith(TENSOR_SUFFIXES)
