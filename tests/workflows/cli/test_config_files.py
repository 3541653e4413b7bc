"""Files of parameters: what a dump writes a run reads back, and what is wrong with a file is one line."""

import json
import os
import re

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant
from moseg.schemas.errors import InputError
from moseg.schemas.presets import GEOMETRIES, PRESETS, QUALITIES
from moseg.workflows.config.config_files import MAX_BYTES, read_config_file, write_config
from moseg.workflows.config.parameters import list_parameters
from moseg.workflows.config.pipeline_choices import PipelineChoices
from moseg.workflows.config.trajectory_choices import TrajectoryChoices

pytestmark = pytest.mark.usefixtures("in_empty_folder")

VALUES = {
    "max_side": st.integers(16, 4000).map(str),
    "flow.preset": st.sampled_from(["ultrafast", "fine"]),
    "fundamental.gap": st.integers(1, 9).map(str),
    "fundamental.min_conditioning": st.floats(0, 1, exclude_min=True).map(repr),
    "saliency.floor": st.sampled_from(["1e-3", "0.25", "3", "1E+1", "1_0.5"]),
    "saliency.focals": st.lists(st.floats(0.1, 9), min_size=1, max_size=4),
    "detections.tags": st.sampled_from(["no", "null", "car, person", "é", "'quoted'", "on: off", "#", "1e3", "~"]),
    "affinity.excess": st.sampled_from(["yes", "no", "true", "off", "0"]),
    "clustering.motions": st.sampled_from(["gt", "auto", "3"]),
    "clustering.count.affinity.models": st.just(["homography"]),
    "trajectory_clustering.pieces.counts": st.sampled_from(["4", "9,3"]),
    "hypotheses.gaps": st.sampled_from(["1", "1,3"]),
}


def _config(preset, geometry, quality, chosen):
    from moseg.workflows.config.pipeline_choices import choose_preset

    values = choose_preset(preset, geometry, quality)
    for name, value in chosen.items():
        *stages, last = name.split(".")
        inner = values
        for stage in stages:
            inner[stage] = dict(inner.get(stage, {}))
            inner = inner[stage]
        inner[last] = value
    return PipelineConfig.model_validate(values)


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    preset=st.sampled_from(list(PRESETS)),
    geometry=st.sampled_from(list(GEOMETRIES)),
    quality=st.sampled_from(list(QUALITIES)),
    chosen=st.fixed_dictionaries({}, optional=VALUES),
    changed_only=st.booleans(),
)
def test_a_written_configuration_is_read_back_the_same(tmp_path, preset, geometry, quality, chosen, changed_only):
    config = _config(preset, geometry, quality, chosen)
    path = tmp_path / "config.yaml"
    path.write_text(write_config(config, changed_only=changed_only), encoding="utf-8")
    read = PipelineConfig.model_validate(read_config_file(path))
    assert read == config
    assert read.model_dump_json() == config.model_dump_json()


def test_a_dump_has_every_parameter_and_says_what_each_means(moseg):
    ran = moseg("config", "dump", "--set", "fundamental.gap=7")
    assert (ran.code, ran.err) == (0, "")
    names = set()

    def walk(values, path):
        for name, value in values.items():
            if isinstance(value, dict):
                walk(value, (*path, name))
            else:
                names.add(".".join((*path, name)))

    walk(yaml.safe_load(ran.out), ())
    assert names == set(list_parameters())
    words = " ".join(ran.out.replace("#", " ").split())
    for parameter in list_parameters().values():
        assert " ".join(parameter.description.split()) in words
    assert words.count("CHANGED") == 1
    assert re.search(r"\[>= 1; frames; CHANGED, default 3\]\s+gap: 7", ran.out)
    assert max(map(len, ran.out.splitlines())) <= 110


def test_a_dump_of_changes_alone_leaves_out_the_rest(moseg):
    ran = moseg("config", "dump", "--changed", "--quality", "best", "--set", "clustering.count.gap=5")
    changed = {name: dict(chosen) for name, chosen in QUALITIES["best"].items()}
    assert yaml.safe_load(ran.out) == changed | {"clustering": {"count": {"gap": 5}}}
    assert yaml.safe_load(moseg("config", "dump", "--changed").out) == {}


def test_a_run_with_a_dumped_file_reuses_everything(evaluated_copy, moseg, tmp_path):
    options = ("--section-length", "4", "--set", "sections.overlap=2")
    assert moseg("config", "dump", *options, "--out", tmp_path / "dumped.yaml").code == 0
    data = ("--dataset", "folder", "--root", evaluated_copy.root, "--store", evaluated_copy.store, "--quiet")
    ran = moseg("eval", *data, "--config", tmp_path / "dumped.yaml", "--json", tmp_path / "report.json")
    assert (ran.code, ran.err) == (0, "")
    assert json.loads((tmp_path / "report.json").read_text())["store"]["computed"] == 0


def test_every_preset_can_be_dumped_and_planned(moseg, tmp_path):
    for preset in PRESETS:
        path = tmp_path / f"{preset}.yaml"
        assert moseg("config", "dump", "--preset", preset, "--geometry", "paper", "--out", path).code == 0
        again = moseg("config", "dump", "--config", path)
        assert again.out == path.read_text(encoding="utf-8")


def test_options_come_before_the_file_and_the_file_before_a_preset(moseg, tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text("flow: {method: dis}\nfundamental: {gap: 5, num_refits: 2}\n")
    given = ("--preset", "paper", "--geometry", "paper", "--config", path)
    values = yaml.safe_load(moseg("config", "dump", *given, "--set", "fundamental.gap=6", "--depth", "none").out)
    assert values["flow"]["method"] == "dis"
    assert values["depth"]["method"] == "none"
    assert values["fundamental"]["gap"] == 6
    assert values["fundamental"]["num_refits"] == 2
    # Of what the file does not name the preset's and the geometry's stay.
    assert values["tracks"]["method"] == "pips"
    assert values["fundamental"]["statistic"] == "mean"


@pytest.mark.parametrize(
    "command", ["segment video.mp4", "eval", "ablate", "plan", "contact-sheet", "config dump"], ids=str.split
)
def test_every_command_with_the_pipelines_options_takes_a_file(moseg, command):
    ran = moseg(*command.split(), "--config", "nowhere.yaml")
    assert ran.code == 2
    assert "nowhere.yaml" in ran.err
    assert "--config" in moseg(*command.split(), "--help").out


BAD = {
    "fundamental: {gap: three}": ("fundamental.gap", "'three'", "integer"),
    "fundamental: {gap: 0}": ("fundamental.gap", "'0'", "greater than or equal to 1"),
    "fundamental: {gap: yes}": ("fundamental.gap", "'yes'", "integer"),
    "fundamental: {gab: 3}": ("unknown parameter 'fundamental.gab'", "did you mean 'fundamental.gap'?"),
    "fundamentl: {gap: 3}": ("unknown parameter 'fundamentl'", "did you mean 'fundamental'?"),
    "gap: 3": ("unknown parameter 'gap'", "fundamental.gap"),
    "fundamental.gap: 3": ("a name with a dot", "line 1"),
    "fundamental: 3": ("fundamental", "parameters by name"),
    "flow: {method: rafft}": ("flow.method", "'rafft'", "did you mean 'raft'?"),
    "saliency: {focals: [1, two]}": ("saliency.focals", "'two'"),
    "saliency: {floor: .nan}": ("saliency.floor", "'.nan'"),
    "clustering: {count: {affinity: {gap: -1}}}": ("clustering.count.affinity.gap", "'-1'"),
    "clustering: {count: {affinity: {models: [oc, oc]}}}": ("clustering.count.affinity.models", "different models"),
    "track_groups: {models: [affine, affine]}": ("track_groups.models", "different models"),
    "track_groups: {clustering: {auto: stability}}": ("track_groups.clustering.auto", "'stability'", "'energy'"),
    "rigidity: {neighbours: 31}": ("rigidity", "neighbours of at most neighbour_candidates"),
    "max_side: 300\nmax_side: 400": ("'max_side' twice", "line 2"),
    "flow: [\n": ("line 2",),
    "flow:\n\tmethod: dis": ("line 2",),
    "- flow": ("a list",),
    "only words": ("only words",),
    "": ("without parameters",),
    "# all is commented out\n": ("without parameters",),
    "max_side: 300\n---\nmax_side: 400": ("another document",),
    "flow: !!python/object/apply:os.system [ls]": ("line 1", "constructor"),
    "a: &a [x, x]\nb: &b [*a, *a]\nc: [*b, *b]": ("alias", "line 2"),
    "[" * 500: ("nested too deep",),
    "max_side: \x07": ("special characters",),
    "? [flow]\n: 3": ("a name that is no text",),
}


@pytest.mark.parametrize("text", BAD, ids=range(len(BAD)))
def test_what_is_wrong_with_a_file_is_one_line(moseg, tmp_path, text):
    path = tmp_path / "bad.yaml"
    path.write_text(text, encoding="utf-8")
    ran = moseg("eval", "--config", path)
    assert ran.code == 2
    (line,) = ran.err.splitlines()
    for word in (str(path), *BAD[text]):
        assert word in line


def test_what_is_no_readable_file_is_one_line(moseg, tmp_path):
    latin = tmp_path / "latin.yaml"
    latin.write_bytes("detections: {tags: Bär}".encode("latin-1"))
    huge = tmp_path / "huge.yaml"
    huge.write_bytes(b"# " + b"x" * MAX_BYTES)
    cases = {latin: "UTF-8", huge: "too large", tmp_path: "folder", tmp_path / "none.yaml": "no such"}
    for path, word in cases.items():
        ran = moseg("plan", "--config", path)
        assert ran.code == 2
        (line,) = ran.err.splitlines()
        assert word in line
        assert str(path) in line


def test_numbers_and_words_are_read_as_they_are_by_set(tmp_path):
    path = tmp_path / "pitfalls.yaml"
    path.write_text(
        "\ufefffundamental: {min_conditioning: 1e-3, gap: 010}\n"
        "detections: {tags: [no, on, 1e3, 2001-01-01, 1:30]}\naffinity: {excess: no}\nclustering: {motions: '2'}\n"
        "sections:\n  # length: 3\nram: {weights: ~}\n",
        encoding="utf-8",
    )
    config = PipelineConfig.model_validate(read_config_file(path))
    assert (config.fundamental.min_conditioning, config.fundamental.gap) == (1e-3, 10)
    assert config.detections.tags == ("no", "on", "1e3", "2001-01-01", "1:30")
    assert config.affinity.excess is False
    assert config.clustering.motions == 2
    assert config.sections == PipelineConfig().sections
    assert config.ram.weights is None


def test_a_folder_in_a_file_still_needs_its_path(moseg, tmp_path):
    path = tmp_path / "depth.yaml"
    path.write_text("depth: {method: folder}\n")
    ran = moseg("plan", "--config", path)
    assert ran.code == 2
    assert "--depth folder:PATH" in ran.err


def test_trajectories_take_a_full_file_but_no_changes_for_images(tmp_path):
    path = tmp_path / "full.yaml"
    path.write_text(write_config(PipelineConfig()))
    choices = PipelineChoices(str(path))
    config = choices.read()
    assert TrajectoryChoices().apply(choices, config, "kt3dmoseg", TrajectoryVariant) == PipelineConfig()
    path.write_text(write_config(PipelineConfig(max_side=300)))
    with pytest.raises(InputError, match="max_side"):
        TrajectoryChoices().apply(choices, config, "kt3dmoseg", TrajectoryVariant)


def test_a_configuration_from_a_pipe_is_refused_by_name(moseg, tmp_path):
    # It would be empty when the work reads it again.
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    ran = moseg("segment", tmp_path / "frames", "--config", pipe)
    assert ran.code == 2 and ran.err.count("\n") == 1
    assert f"a configuration file that can be read only once in {pipe}; got a pipe" in ran.err
