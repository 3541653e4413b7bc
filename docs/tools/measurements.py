"""Measurements behind the figures of the documents, in the order in which `make results RERUN=all` repeats them.

A measurement is one command line. Its result is ``benchmarks/results/<name>.json``. Data sets come one after the other,
and commands that compute cues come before those that reuse them: in a store of their own, each command computes only
the artifacts that those before it have not computed.
"""

from fnmatch import fnmatchcase
from typing import NamedTuple

from measured_data import DATA, TRACKS

DAVIS = f"--dataset davis16 {DATA['davis'].arguments}"
TRAJECTORIES = f"--dataset kt3dmoseg {DATA['kt3dmoseg'].arguments} --seeds 5"
ROADS = f"--dataset kt3dinsmoseg {DATA['kt3dmoseg'].arguments}"
STILL = f"--dataset still {DATA['still'].arguments}"
SYNTHETIC = "--dataset synthetic"
PEERS = "python benchmarks/peers/compare.py"
ORACLE = f"{SYNTHETIC} --proposals groundtruth"
EXACT = f"{ORACLE} --flow groundtruth --depth groundtruth --tracks groundtruth"
SPECTRAL = "--set clustering.grouping=spectral --set clustering.fusion=coregularised"
PAPER_CLUSTERING = f"--affinity ork {SPECTRAL}"
XU_LAMBDA = "--set clustering.co_regularisation=0.01"
PRINTED_SIGNS = "--set fused_flow_model=oc_depth_paper"

SETTINGS = {"synthetic": SYNTHETIC, "exact": EXACT, "oracle": ORACLE, "davis": DAVIS}
"""Settings of comparisons of affinities: with default proposals and cues; with true proposals and exact cues; with true
proposals, DIS and Lucas-Kanade, without depth; on real video."""
AFFINITIES = {
    "residual": "",
    "paper": "--geometry paper",
    "hypotheses": "--affinity hypotheses",
    "combined": "--affinity combined",
}
MOTIONS = ("auto", "gt")
THRESHOLDS = (1, 2, 3)
READINGS = ("models", "objects")
STATIC = ("group", "agreement")
SWEEPS = {
    "hypotheses": ("object_hypotheses.num_hypotheses", ("100", "199", "200", "201", "400")),
    "window": ("object_hypotheses.window", ("0.1", "0.15", "0.2", "0.25", "0.3")),
    "rows": ("object_hypotheses.background_rows", ("2", "3", "4")),
}
"""Parameters of the affinity of many hypotheses, and their values. The number of columns is that of rows plus one."""
COUNTS = ("description_length", "geometric", "confidences", "stability", "eigengap")
VIEWS = {
    "two-views": "--views homography,fundamental",
    "four-views": "--views affine,homography,fundamental,trifocal",
}
SENSITIVITIES = ("0.25", "0.5", "0.7", "1.5", "2", "4")
"""Of objects of tracks, beside the default of 1."""
ROAD_SEEDS = ("1", "2", "3", "4")
"""Of the camera's motion and of the motion groups, beside the default of 0."""
ROAD_PARTS = {
    "gap-2": "--set rigidity.gaps=2",
    "gap-4": "--set rigidity.gaps=4",
    "no-patch-test": "--set rigidity.test_gain=1000000",
    "no-behind": "--set rigidity.test_behind=0",
    "no-contact": "--set rigidity.contact_lift=2",
    "no-field": "--set track_field.coupling=0",
    "no-groups": "--set track_groups.min_moving=1000000",
    "no-static-parts": "--set track_objects.min_static_test=3",
    "no-following": "--set object_points.max_motions=0",
    "no-outlines": "--set track_masks.softness=0",
    "no-completion": "--set track_objects.min_surface=2",
    "no-scattering": "--set track_objects.min_scattered_score=0",
    "no-comparison": "--set rigid_support.use=never",
}
"""Tracks-first proposals without one of their parts."""
CHOSEN = {"num_hypotheses": "200", "window": "0.2", "background_rows": "3"}


class Measurement(NamedTuple):
    """Measurement: one command line whose result is kept.

    Attributes
    ----------
    name : str
        Name of its file, without the suffix.
    command : str
        Command line, with the placeholders of `DATA` for roots.
    data : str or None
        Key of `DATA`; None if no data set must be given.
    """

    name: str
    command: str
    data: str | None


def chosen(names: str) -> list[Measurement]:
    """Return the measurements named by a list with commas of names, patterns such as ``exact-*``, or ``all``."""
    patterns = ["*" if name == "all" else name for name in names.split(",")]
    unknown = [pattern for pattern in patterns if not any(fnmatchcase(m.name, pattern) for m in CATALOGUE)]
    if unknown:
        raise LookupError(f"no such measurement: {', '.join(unknown)}; `make results` lists them")
    return [m for m in CATALOGUE if any(fnmatchcase(m.name, pattern) for pattern in patterns)]


def _catalogue() -> list[Measurement]:
    commands = {
        "rigid-flow": "python benchmarks/rigid_flow.py",
        "flow-residuals": "python benchmarks/flow_residuals.py",
        "given-cameras": "python benchmarks/given_cameras.py",
        "frame-rates": "python benchmarks/frame_rates.py",
        "slow-motion": "python benchmarks/slow_motion.py --workers 2",
        **_of_setting("synthetic"),
        **_static("synthetic"),
        "synthetic-no-network": f"moseg eval {SYNTHETIC} --set motion_network.use=never",
        "synthetic-layers": f"moseg eval {SYNTHETIC} --motions auto --set saliency.background=layers",
        "peers-synthetic": f"{PEERS} {SYNTHETIC}",
        **_of_setting("exact"),
        **_paper_choices(),
        "exact-paper-lambda-0.01": f"moseg ablate {EXACT} --motions gt --geometry paper {XU_LAMBDA}",
        "exact-paper-printed": f"moseg ablate {EXACT} --motions gt --geometry paper {PRINTED_SIGNS}",
        "exact-paper-clustering": f"moseg ablate {EXACT} --motions gt {PAPER_CLUSTERING}",
        "exact-hypotheses-spectral": f"moseg ablate {EXACT} --motions gt --affinity hypotheses {SPECTRAL}",
        **_of_setting("oracle"),
        "oracle-hypotheses-spectral": f"moseg ablate {ORACLE} --motions gt --affinity hypotheses {SPECTRAL}",
        "oracle-paper-clustering": f"moseg eval {ORACLE} --motions auto {PAPER_CLUSTERING}",
        "oracle-residual-spectral": f"moseg eval {ORACLE} --motions auto {SPECTRAL}",
        **{
            f"oracle-residual-{count}": f"moseg eval {ORACLE} --motions auto --set clustering.auto={count}"
            for count in COUNTS
        },
        **_sweeps(),
        "oracle-depth-residual-auto": f"moseg ablate {ORACLE} --depth groundtruth --motions auto",
        # The first of DAVIS, so that its time is that of a run on an empty store.
        "davis-default": f"moseg eval {DAVIS}",
        **_of_setting("davis"),
        **_static("davis"),
        "davis-fast": f"moseg eval {DAVIS} --quality fast",
        "davis-no-network": f"moseg eval {DAVIS} --set motion_network.use=never",
        "davis-best": f"moseg eval {DAVIS} --quality best",
        "peers-davis": f"{PEERS} {DAVIS}",
        **_trajectories(),
        **_roads(),
    }
    found = []
    for name, command in commands.items():
        data = next((name for name, data in DATA.items() if f"--root {data.root} " in command), None)
        found.append(Measurement(name, " ".join(command.split()), data))
    return found


def _of_setting(setting: str) -> dict[str, str]:
    """Return the measurements of all affinities in one setting, with the number of motions found and given."""
    return {
        f"{setting}-{affinity}-{motions}": f"moseg ablate {SETTINGS[setting]} --motions {motions} {options}"
        for affinity, options in AFFINITIES.items()
        for motions in MOTIONS
    }


def _static(setting: str) -> dict[str, str]:
    """Return the measurements of the decision on static objects, for the default's and the paper's clustering."""
    clusterings = {"ours": "", "paper": f"{PAPER_CLUSTERING} --set clustering.auto=eigengap"}
    return {
        f"{setting}-static-{clustering}-{static}": (
            f"moseg eval {SETTINGS[setting]} --motions auto {options} --set clustering.static={static}"
        )
        for clustering, options in clusterings.items()
        for static in STATIC
    }


def _paper_choices() -> dict[str, str]:
    """Return the measurements of the paper's geometry for each reading of its kernel and each t."""
    return {
        f"exact-paper-{reading}-{t}": (
            f"moseg ablate {EXACT} --motions gt --geometry paper"
            f" --set affinity.ork_reading={reading} --set affinity.ork_threshold={t}"
        )
        for reading in READINGS
        for t in THRESHOLDS
    }


def _sweeps() -> dict[str, str]:
    """Return the measurements of affinities of many hypotheses for other parameters, with true proposals."""
    return {
        f"oracle-{affinity}-{sweep}-{value}": (
            f"moseg eval {ORACLE} --motions auto --affinity {affinity} --set {parameter}={value}"
            + (f" --set object_hypotheses.background_columns={int(value) + 1}" if sweep == "rows" else "")
        )
        for affinity in ("hypotheses", "combined")
        for sweep, (parameter, values) in SWEEPS.items()
        for value in values
        if CHOSEN[parameter.partition(".")[2]] != value
    }


def _trajectories() -> dict[str, str]:
    """Return the measurements on trajectories: motions given and found; on KT3DMoSeg also other choices and seeds."""
    commands = {f"kt3d-{motions}": f"moseg ablate {TRAJECTORIES} --motions {motions}" for motions in ("gt", "auto")}
    commands |= {f"kt3d-gt-{name}": f"moseg eval {TRAJECTORIES} --motions gt {views}" for name, views in VIEWS.items()}
    for method, name, views in (
        ("coregularised", "two-views", VIEWS["two-views"]),
        ("coregularised", "three-views", ""),
        ("sum", "three-views", ""),
    ):
        options = f"{views} --set trajectory_clustering.method={method}"
        commands[f"kt3d-gt-{method}-{name}"] = f"moseg eval {TRAJECTORIES} --motions gt {options}"
    for count in COUNTS:
        options = f"--set trajectory_clustering.auto={count}"
        commands[f"kt3d-auto-{count}"] = f"moseg eval {TRAJECTORIES} --motions auto {options}"
    other_seeds = TRAJECTORIES.removesuffix(" --seeds 5")
    for motions in ("gt", "auto"):
        for seed in (5, 6, 7):
            options = f"--motions {motions} --seed {seed}"
            commands[f"kt3d-{motions}-seed-{seed}"] = f"moseg eval {other_seeds} {options}"
    for name in TRACKS[1:]:
        for motions in ("gt", "auto"):
            data = f"--dataset {name} {DATA[name].arguments} --seeds 5"
            commands[f"{name}-{motions}"] = f"moseg eval {data} --motions {motions}"
    # A few of the sequences decide its mean, and each has other groupings under other seeds.
    for motions in ("gt", "auto"):
        data = f"--dataset hopkins155 {DATA['hopkins155'].arguments} --seeds 15"
        commands[f"hopkins155-{motions}-15-seeds"] = f"moseg eval {data} --motions {motions}"
    return commands


def _roads() -> dict[str, str]:
    """Return the measurements on road scenes and where nothing moves."""
    commands = {f"roads-{motions}": f"moseg ablate {ROADS} --motions {motions}" for motions in MOTIONS}
    commands["road-outlines"] = (
        f"python benchmarks/road_outlines/measure.py --root {DATA['kt3dmoseg'].root} --workers 2"
    )
    commands["roads-fast"] = f"moseg eval {ROADS} --motions auto --quality fast"
    commands["roads-saliency"] = f"moseg eval {ROADS} --motions auto --proposals saliency"
    for seed in ROAD_SEEDS:
        options = f"--set rigidity.seed={seed} --set track_groups.seed={seed}"
        commands[f"roads-seed-{seed}"] = f"moseg eval {ROADS} --motions auto {options}"
    for part, options in ROAD_PARTS.items():
        commands[f"roads-{part}"] = f"moseg eval {ROADS} --motions auto {options}"
    for data, sequences in (("roads", ROADS), ("still", STILL)):
        for value in SENSITIVITIES:
            options = f"--motions auto --set track_objects.sensitivity={value}"
            commands[f"{data}-sensitivity-{value}"] = f"moseg eval {sequences} {options}"
    commands["still-auto"] = f"moseg eval {STILL} --motions auto"
    commands["still-tracks"] = f"moseg eval {STILL} --motions auto --proposals tracks"
    for part, options in ROAD_PARTS.items():
        commands[f"still-{part}"] = f"moseg eval {STILL} --motions auto {options}"
    return commands


CATALOGUE = tuple(_catalogue())
