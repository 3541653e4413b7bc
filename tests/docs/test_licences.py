"""The documents name the licence of every weights item, and mark those that must be accepted."""

import importlib
import re
import sys
from importlib.metadata import requires
from pathlib import Path

import pytest

from moseg.workflows.weights.catalogue import CATALOGUE

DOCS = Path(__file__).resolve().parents[2] / "docs"


def row_of(item: str) -> list[str]:
    """Return the cells of the row of the table of licences that names the item."""
    section = (DOCS / "models.md").read_text(encoding="utf-8").split("### Licences of weights")[1].split("\n## ")[0]
    (row,) = [line for line in section.splitlines() if f"`{item}`" in line]
    return [cell.strip() for cell in row.strip("|").split("|")]


@pytest.mark.parametrize("item", CATALOGUE, ids=lambda item: item.name)
def test_every_weights_item_has_its_licence_in_the_table(item):
    _, _, licence, use = row_of(item.name)
    assert licence == item.licence
    assert ("non-commercial" in use) == item.is_non_commercial
    assert ("conditions" in use) == item.has_conditions
    assert (use == "any") == (not item.consent) and item.consent in use


def test_the_table_has_no_item_that_does_not_exist():
    text = (DOCS / "models.md").read_text(encoding="utf-8").split("### Licences of weights")[1].split("\n## ")[0]
    named = {name for line in text.splitlines() if line.startswith("| ") for name in line.split("`")[1:-1:2]}
    assert named - {item.consent for item in CATALOGUE} == {item.name for item in CATALOGUE}


def test_the_licences_of_all_libraries_are_listed_and_copyleft_ones_are_explained(capsys, monkeypatch):
    monkeypatch.syspath_prepend(str(DOCS / "tools"))
    monkeypatch.setattr(sys, "argv", ["list_licences.py"])
    importlib.import_module("list_licences").main()
    rows = [line.strip("|").split(" | ") for line in capsys.readouterr().out.splitlines()[2:]]
    names = {row[0].strip() for row in rows}
    direct = {re.match(r"[\w.-]+", word).group() for word in requires("moseg") if "extra" not in word}
    assert {name.lower() for name in direct} <= names
    page = (DOCS / "licences.md").read_text(encoding="utf-8")
    assert all(f"**{row[0].strip()}**" in page for row in rows if "copyleft" in row[-1])
