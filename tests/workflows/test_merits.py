"""`moseg backends --why`: what each choice gives by public figures, what it costs, and under which licence."""

import json
import re
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.presets import LIGHT, PRESETS
from moseg.workflows.cli.merits_table import list_sources, merits_table
from moseg.workflows.config.pipeline_choices import PipelineChoices, choose_preset
from moseg.workflows.stages.merits import list_merits, sum_costs
from moseg.workflows.stages.needed_weights import needed_items
from moseg.workflows.weights import costs
from moseg.workflows.weights.catalogue import CATALOGUE
from moseg.workflows.weights.figures import FIGURES

ITEMS = {item.name: item for item in CATALOGUE}


def _config(preset, light=False):
    return PipelineConfig.model_validate(choose_preset(preset, light=light))


@pytest.fixture
def measured(tmp_path, monkeypatch):
    """Return a function that puts measurements in place of the benchmark's file."""

    def write(seconds):
        path = tmp_path / "costs.json"
        path.write_text(json.dumps({name: {"seconds": s, "reference": r} for name, (s, r) in seconds.items()}))
        monkeypatch.setattr(costs, "_FILE", path)

    return write


def test_every_item_of_the_catalogue_has_a_row_with_its_licence():
    rows = list_merits(ITEMS)
    assert {row.weights for row in rows} - {""} == set(ITEMS)
    assert all(row.licence == ITEMS[row.weights].licence for row in rows if row.weights)
    assert ("flow", "--flow dis", "OpenCV, Apache-2.0") in {(row.choice, row.option, row.licence) for row in rows}


def test_figures_are_of_known_items_and_name_their_source():
    assert FIGURES.keys() <= ITEMS.keys()
    assert all(figure.text and figure.source for figure in FIGURES.values())


def test_an_item_that_tracks_and_outlines_has_a_cost_for_each():
    rows = {row.choice: row for row in list_merits(ITEMS) if row.weights == "sam2.1-hiera-large"}
    assert (rows["masks"].frames, rows["tracker"].frames) == ("section", "frame")
    assert rows["masks"].seconds != rows["tracker"].seconds
    assert rows["masks"].figure == rows["tracker"].figure


@pytest.mark.parametrize(("preset", "light"), [*((name, False) for name in PRESETS), *((name, True) for name in LIGHT)])
def test_the_cost_of_every_network_of_a_preset_was_measured(preset, light):
    assert sum_costs(_config(preset, light), light).unmeasured == ()


def test_costs_are_compared_by_those_of_raft_in_the_same_run(measured):
    measured({"raft-large": (10, 10), "sea-raft-m": (12, 15)})
    assert costs.read_costs() == {"raft-large": 10.0, "sea-raft-m": pytest.approx(8.0)}


def test_a_sum_divides_what_runs_once_a_section_and_names_what_was_not_measured(measured):
    measured({"raft-large": (10, 10), "ram": (60, 10), "deaot-r50-l": (4, 10)})
    found = sum_costs(_config("paper"))
    assert found.seconds == pytest.approx(10 + 60 / 30 + 4)
    assert set(found.unmeasured) == set(needed_items(_config("paper"))) - {"raft-large", "ram", "deaot-r50-l"}


def test_prompts_from_motion_count_masks_and_flow_in_both_directions(measured):
    measured({"raft-large": (10, 10), "sam2.1-hiera-large": (60, 10), "sam2.1-hiera-large-video": (40, 10)})
    settings = (("proposal_source", "motion-prompts"), ("flow.method", "raft"))
    assert sum_costs(PipelineChoices(settings=settings).make_config()).seconds == pytest.approx(2 * 10 + 60 / 30 + 40)


def test_lighter_parameters_have_costs_of_their_own(measured):
    measured({"raft-large": (10, 10), "sea-raft-s": (5, 10), "sea-raft-s@light": (2, 10)})
    values = {"flow": {"method": "sea-raft"}, "sea_raft": {"weights": "sea-raft-s"}}
    flow = PipelineConfig.model_validate({"proposal_source": "groundtruth", **values})
    assert [sum_costs(flow, light).seconds for light in (False, True)] == [5.0, 2.0]


def test_the_file_of_costs_names_items_of_the_catalogue():
    names = json.loads(Path(costs.__file__).with_name("costs.json").read_text(encoding="utf-8"))
    uses = r"(-video|-views|-rays)?(@light)?$"
    assert {re.sub(uses, "", name) for name in names} <= ITEMS.keys()


def test_the_command_prints_a_table_and_the_seconds_of_presets(moseg):
    ran = moseg("backends", "--why")
    assert (ran.code, ran.err) == (0, "")
    lines = ran.out.splitlines()
    (index,) = (index for index, line in enumerate(lines) if "--flow sea-raft" in line)
    assert "sea-raft-m" in lines[index + 1] and "BSD-3-Clause" in lines[index + 1] and " a frame" in lines[index + 1]
    number = 1 + list_sources(list_merits(ITEMS)).index(FIGURES["sea-raft-m"].source)
    assert f"[{number}]" in ran.out and f"    [{number}] {FIGURES['sea-raft-m'].source}" in ran.out
    for words in ("modern", "modern --light", "modern --light --proposals motion-prompts"):
        assert re.search(rf"    --preset {words}: [\d.]+ s, on 4 cores [\d.]+ s", ran.out)


@pytest.mark.parametrize("width", [80, 100, 160])
def test_names_options_and_licences_stay_whole_in_a_terminal(width):
    rows = list_merits(ITEMS)
    out = StringIO()
    sources = list_sources(rows)
    Console(file=out, width=width).print(merits_table(rows, sources))
    text = out.getvalue()
    assert {line.strip()[-1] for line in text.splitlines()[1:]} <= set("┓┃┩│┤┘")
    for row in rows:
        assert row.weights in text
        assert all(part in text for part in row.licence.split(", "))
        assert all(word in text for word in re.findall(r"[^\s=]+=?", row.option))
        if row.figure is not None:
            assert f"[{1 + sources.index(row.figure.source)}]" in text


def test_the_document_states_the_sums_of_the_file_of_costs():
    text = (Path(__file__).resolve().parents[2] / "docs" / "models.md").read_text(encoding="utf-8")
    seconds = [sum_costs(_config("modern", light), light).seconds for light in (True, False)]
    stated = re.search(r"take\s(\S+) CPU seconds per frame.*`modern` takes (\d+)\)", text)
    assert stated.groups() == (f"{seconds[0]:.1f}", f"{seconds[1]:.0f}")
    prompted = PipelineChoices(preset="modern", light=True, settings=(("proposal_source", "motion-prompts"),))
    seconds = sum_costs(prompted.make_config(), light=True).seconds
    assert f"`--proposals motion-prompts` it is\n{seconds:.1f} s and {seconds / 4:.1f} s" in text
    ratios = {size: costs.read_costs()[f"sea-raft-{size}"] / costs.read_costs()["raft-large"] for size in "ms"}
    rows = {"EdgeTAM": "edgetam", "EdgeTAM video": "edgetam-video", "SAM 3": "sam3", "SAM 3 video": "sam3-video"}
    for row, name in rows.items():
        shown = costs.read_costs()[name]
        assert re.search(rf"\| {row} \| [^|]+ \| {shown:.{0 if shown >= 10 else 1}f} \|", text), row
    assert f"in that run ({ratios['m']:.2f} and {ratios['s']:.2f})" in text
