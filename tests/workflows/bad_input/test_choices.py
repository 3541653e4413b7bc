"""Options that name what does not exist, and numbers that no option can take."""

import pytest

CHOICES = {
    "--preset papr": "'paper'",
    "--quality god": "--quality",
    "--geometry flat": "--geometry",
    "--variant oc_depth": "'oc-depth'",
    "--flow farneback": "flow.method",
    "--depth dpt": "depth.method",
    "--tracks cotracker": "tracks.method",
    "--proposals sam": "proposal",
    "--affinity cosine": "affinity.method",
    "--tagger yolo": "detections.tagger",
    "--masks sam3": "detections.masks",
    "--tracker sort": "detections.tracker",
    "--device gpu": "unknown device",
    "--device cuda:x": "device",
    "--scheduler tcp://": "--scheduler",
    "--tls-ca gone": "--tls-ca",
    "--export voc": "voc",
    "--config gone.yaml": "gone.yaml",
}
NUMBERS = {
    "--fps": ["0", "-1", "nan", "inf", "-inf", "1e300", "1e-300", "fast", ""],
    "--workers": ["-1", "10000", "1.5", "two", "nan", ""],
    "--threads": ["0", "-1", "100000", "1.5", "nan"],
    "--batch": ["0", "-3", "nan", "1e3"],
    "--section-length": ["0", "-1", "nan", "1e9", ""],
    "--motions": ["0", "-1", "nan", "inf", "2.5", "some"],
    "--sensitivity": ["0", "-1", "nan", "inf", "-inf", "high", ""],
}
PARAMETERS = {
    "--section-length": "sections.length",
    "--motions": "clustering.motions",
    "--sensitivity": "track_objects.sensitivity",
}
"""What an option sets, where the line names that."""
SETTINGS = [
    "max_side=0",
    "max_side=inf",
    "max_side=1e400",
    "saliency.floor=nan",
    "saliency.floor=inf",
    "saliency.floor=-inf",
    "fundamental.gap=0",
    "fundamental.gap=-1",
    "fundamental.gap=1.5",
    "fundamental.gab=3",
    "flow=3",
    "flow.method.x=3",
    "flow.method",
    "=3",
    ".=3",
    "",
]


@pytest.mark.parametrize("choice", CHOICES)
def test_what_does_not_exist_is_named(refuse, write_folder, choice):
    refuse(write_folder(), CHOICES[choice], options=choice.split())


@pytest.mark.parametrize("name", ["--preset", "--quality", "--geometry", "--variant", "--flow", "--depth", "--device"])
def test_an_empty_name_is_none(refuse, write_folder, name):
    refuse(write_folder(), options=(name, ""))


@pytest.mark.parametrize(("option", "value"), [(name, value) for name, values in NUMBERS.items() for value in values])
def test_a_number_out_of_range_names_its_option(refuse, write_folder, option, value):
    line = refuse(write_folder(), options=(f"{option}={value}",))
    assert option in line or PARAMETERS.get(option, option) in line


@pytest.mark.parametrize("source", [("--proposals", "saliency"), ("--proposals", "detections")])
def test_a_sensitivity_where_proposals_never_come_from_tracks_is_refused(refuse, write_folder, source):
    says = (
        "an option of tracks in --sensitivity",
        "--proposals motion-prompts or --proposals auto or --proposals tracks",
    )
    refuse(write_folder(), *says, options=("--sensitivity", "2", *source))


@pytest.mark.parametrize("setting", SETTINGS)
def test_a_setting_that_is_none_is_refused(refuse, write_folder, setting):
    refuse(write_folder(), options=("--set", setting))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("eval --dataset sintetic", "synthetic"),
        ("eval --dataset davis17", "davis"),
        ("eval --dataset=", "unknown data set; got ''"),
        ("eval --sequences=", "--sequences"),
        ("ablate --dataset kt3dmoseg", "$MOSEG_DATA"),
        ("eval --root=", "root"),
        ("segment", "for example"),
        ("segmnet film.mp4", "segment"),
        ("segment --quallity fast film.mp4", "--quality"),
    ],
)
def test_a_command_line_that_cannot_work_says_how_to_go_on(moseg, assert_refused, in_empty_folder, arguments, words):
    assert_refused(moseg(*arguments.split()), words)


CONFIGS = {
    "no YAML": ("a: [1", ""),
    "a list": ("- 1\n- 2\n", ""),
    "a number": ("7\n", ""),
    "an unknown stage": ("nostage:\n  gap: 3\n", "nostage"),
    "an unknown parameter": ("fundamental:\n  gab: 3\n", "gab"),
    "a wrong value": ("fundamental:\n  gap: three\n", "fundamental.gap"),
    "not a number": ("saliency:\n  floor: .nan\n", "saliency.floor"),
    "bytes": ("\x00\x01", ""),
}


@pytest.mark.parametrize("kind", CONFIGS)
def test_a_malformed_config_is_named(refuse, write_folder, tmp_path, kind):
    text, words = CONFIGS[kind]
    path = tmp_path / "config.yaml"
    path.write_text(text)
    refuse(write_folder(), words, options=("--config", path))


def test_a_config_that_is_a_folder_is_named(refuse, write_folder, tmp_path):
    (tmp_path / "configs").mkdir()
    refuse(write_folder(), tmp_path / "configs", options=("--config", tmp_path / "configs"))
