"""Tables of measured figures in the documents: texts of their cells, with ``{expression}`` for each figure."""

import road_tables
import trajectory_tables
from measured_data import DATA
from measurements import AFFINITIES, MOTIONS, READINGS, SWEEPS, THRESHOLDS
from table_cells import SCORES, VIEWS, Rows, scores_of

VARIANTS = (*VIEWS, "base")
QUALITIES = ("fast", "default", "best")


def table(name: str) -> str:
    """Return a table in Markdown."""
    head, *rows = TABLES[name]
    return "".join(f"| {' | '.join(row)} |\n" for row in (head, ("---",) * len(head), *rows)).replace("| --- ", "|---")


def _each(name: str, variants: tuple[str, ...], score: str = "F") -> tuple[str, ...]:
    return tuple(f"{{{name}/{variant}/{score}}}" for variant in variants)


def _davis_sequences() -> Rows:
    rows = []
    for sequence in DATA["davis"].sequences:
        rows.append((sequence, *(f"{{davis-residual-auto/fused/{score}@{sequence}}}" for score in "FJ")))
    return [("sequence", "Fu", "J"), *rows]


def _synthetic() -> Rows:
    settings = {
        "oracle, exact cues, `auto`": "exact-residual-auto",
        "oracle, exact cues, `gt`": "exact-residual-gt",
        "oracle, exact depth, DIS and Lucas-Kanade, `auto`": "oracle-depth-residual-auto",
        "oracle, no depth, DIS and Lucas-Kanade, `auto`": "oracle-residual-auto",
        "the paper's affinity and clustering, oracle, exact cues, `gt`": "exact-paper-clustering",
        "the same with the paper's fits and residuals": "exact-paper-gt",
        "the same with equation 1 as printed": "exact-paper-printed",
        "weights-free, `auto` (`moseg ablate`)": "synthetic-residual-auto",
    }
    return [("setting", *VARIANTS), *((text, *_each(name, VARIANTS)) for text, name in settings.items())]


def _paper_choices() -> Rows:
    texts = {"models": "models for each object's data (default)", "objects": "objects under each model (literal)"}
    rows = [
        (texts[reading], str(t), *_each(f"exact-paper-{reading}-{t}", VIEWS))
        for reading in READINGS
        for t in THRESHOLDS
    ]
    return [("what is ranked", "t", *VIEWS), *rows]


def _what_is_static() -> Rows:
    rows = []
    for text, clustering in (
        ("`residual`, linkage (default)", "ours"),
        ("ORK, spectral, co-regularised, eigengap", "paper"),
    ):
        cells = [
            " / ".join(f"{{{setting}-static-{clustering}-{static}/fused/F}}" for setting in ("synthetic", "davis"))
            for static in ("agreement", "group")
        ]
        rows.append((text, *cells, "{synthetic-residual-auto/base/F} / {davis-residual-auto/base/F}"))
    return [("", "agreement (default)", "the background's group", "base"), *rows]


def _many_hypotheses() -> Rows:
    settings = {
        "exact": "synthetic, oracle, exact cues",
        "oracle": "synthetic, oracle, no depth",
        "synthetic": "synthetic, weights-free",
        "davis": "DAVIS-2016, eight sequences",
    }
    rows = [
        (
            text if motions == "gt" else "",
            f"`{motions}`",
            *(" / ".join(_each(f"{setting}-{affinity}-{motions}", VIEWS)) for affinity in _BY_PAPER_FIRST),
        )
        for setting, text in settings.items()
        for motions in reversed(MOTIONS)
    ]
    return [_AFFINITY_HEAD, *rows]


_BY_PAPER_FIRST = ("paper", *(name for name in AFFINITIES if name != "paper"))
_AFFINITY_HEAD = ("", "motions", "the paper", "`residual` (default)", "`hypotheses`", "`combined`")


def _davis_hypotheses_j() -> Rows:
    cells = (" / ".join(_each(f"davis-{affinity}-auto", VIEWS, "J")) for affinity in _BY_PAPER_FIRST)
    return [_AFFINITY_HEAD, ("DAVIS-2016, eight sequences, J", "`auto`", *cells)]


def _sweeps() -> Rows:
    texts = {"hypotheses": "hypotheses", "window": "window", "rows": "rows of cells (columns: one more)"}
    defaults = {"200", "0.2", "3"}
    rows = []
    for sweep, (_, values) in SWEEPS.items():
        for value in values:
            names = [
                f"oracle-{affinity}-auto" if value in defaults else f"oracle-{affinity}-{sweep}-{value}"
                for affinity in ("hypotheses", "combined")
            ]
            note = " (default)" if value in defaults else ""
            rows.append((texts[sweep], value + note, *(f"{{{name}/fused/F}}" for name in names)))
    return [("parameter", "value", "`hypotheses`", "`combined`"), *rows]


def _rigid_flow() -> Rows:
    texts = {
        "rigid/oc_depth": "`oc_depth`",
        "zoomed/oc_depth": "`oc_depth`; zoom, inverse depth scaled and shifted",
        "stored/oc_depth": "`oc_depth`; flow and inverse depth stored as float32",
        "off-centre/oc_depth": "`oc_depth`; principal point 5 % of the longer side off the image's centre",
        "rigid/oc_depth_paper": "`oc_depth_paper`, the signs as printed",
        "rigid/oc": "`oc`, without depth",
    }
    forms = {path: ":.1f" if path.startswith("off") or path.split("/")[1] != "oc_depth" else ":.0e" for path in texts}
    rows = [
        (text, *(f"{{rigid-flow/{path}/{statistic}{forms[path]}}}" for statistic in ("median", "p95", "max")))
        for path, text in texts.items()
    ]
    return [("share of the RMS flow not explained, percent", "median", "95th percentile", "largest"), *rows]


def _held_out() -> Rows:
    davis = "twelve other sequences of DAVIS-2016's validation set"
    rows = [
        (davis if not number else "", text, *(f"{{held-out/davis16/{path}/{score}}}" for score in scores), *empty)
        for number, (text, path, scores, empty) in enumerate(
            (
                ("fused, default", "default/fused", "JF", ("",)),
                ("fused, `--quality best`", "best/fused", "JF", ("",)),
                ("trajs, `--quality best`", "best/trajs", "J", ("", "")),
                ("oc, `--quality best`", "best/oc", "J", ("", "")),
                ("oc-depth, `--quality best`", "best/oc-depth", "J", ("", "")),
            )
        )
    ]
    clips = ("eleven other clips of KT3DMoSeg", "number of motions given", "", "", "{held-out/kt3dmoseg/gt/error}")
    return [("data", "", "J", "Fu", "misclassified trajectories, percent"), *rows, clips]


def _training_curve() -> Rows:
    shown = range(1000, 9000, 1000)
    figures = {"loss": ":.3f", "J": "", "false_pixels": ""}
    rows = ((f"{n:,}", *(f"{{motion-network/steps/{n}/{k}{form}}}" for k, form in figures.items())) for n in shown)
    return [("step", "loss", "J, held-out scenes", "false pixels where nothing moves, percent"), *rows]


def _networks_on_gpu() -> Rows:
    """Pairs of networks of one kind share a row, as in the table of CPU seconds."""
    kinds = {
        "RAM, RAM++": ("ram", "ram-plus"),
        "Grounding DINO tiny, base": ("grounding-dino-tiny", "grounding-dino-base"),
        "SAM-HQ base, large": ("sam-hq-vit-base", "sam-hq-vit-large"),
        "SAM 2.1 tiny, large": ("sam2.1-hiera-tiny", "sam2.1-hiera-large"),
        "EdgeTAM": ("edgetam",),
        "SAM 3": ("sam3",),
        "DeAOT": ("deaot-r50-l",),
        "SAM 2.1 video tiny, large": ("sam2.1-hiera-tiny-video", "sam2.1-hiera-large-video"),
        "EdgeTAM video": ("edgetam-video",),
        "SAM 3 video": ("sam3-video",),
        "PIPs": ("pips",),
        "BootsTAPIR at 512x512": ("bootstapir",),
        "RAFT large, small": ("raft-large", "raft-small"),
        "SEA-RAFT M, S": ("sea-raft-m", "sea-raft-s"),
        "DPT-DINOv2 small, large": ("dpt-dinov2-small-nyu", "dpt-dinov2-large-nyu"),
        "Depth Anything V2 small": ("depth-anything-v2-small",),
        "Depth Anything 3 small, base": ("depth-anything-3-small", "depth-anything-3-base"),
        "Depth Anything 3 small, base, cameras by the decoder": (
            "depth-anything-3-small-views",
            "depth-anything-3-base-views",
        ),
        "the same by rays": ("depth-anything-3-small-rays", "depth-anything-3-base-rays"),
    }

    def figures(names: tuple[str, ...], figure: str) -> str:
        return ", ".join(
            f"{{networks-on-gpu/networks/{name}/{figure}:.{1 if figure == 'gib' else 3}f}}" for name in names
        )

    has_batches = ("RAFT", "SEA-RAFT", "DPT", "Depth Anything V2", "Depth Anything 3 small, base")
    rows = [
        (
            text,
            figures(names, "s_per_frame"),
            figures(names, "s_per_frame_batch") if text.startswith(has_batches) and "cameras" not in text else "",
            figures(names, "gib"),
        )
        for text, names in kinds.items()
    ]
    return [("network", "s per frame", "s per frame, 8 at once", "GiB"), *rows]


def _network_sizes() -> Rows:
    names = {"before": "the network before this one", "sizes/16": "this one, 16 to 128 channels"}
    names |= {"sizes/24": "24 to 192 channels", "sizes/32": "32 to 256 channels"}
    forms = {"J": ":.1f", "false_pixels": ":.1f", "davis_J": ":.1f"}
    rows = [(text, *(f"{{motion-network/{n}/{k}{form}}}" for k, form in forms.items())) for n, text in names.items()]
    head = ("J, held-out scenes", "false pixels where nothing moves, percent", "J, DAVIS-2016, whole pipeline")
    return [("", *head), *rows]


def _small_frames() -> Rows:
    cells = [
        (
            f"{side} px",
            *(f"{{small-frames/{when}/{side}/{score}}}" for when in ("before", "now") for score in ("J", "F")),
        )
        for side in (640, 427, 320, 240, 160)
    ]
    return [("longer side", "J, as they are", "Fu", "J, enlarged", "Fu"), *cells]


def _texture() -> Rows:
    texts = {
        "colour": "colour alone, 32 bins of each of L, a and b, sigma 1 bin",
        "joint": "colour and texture in one histogram, 16 and 8 bins, sigma 0.5 bins of colour",
        "default": "textures compared in one colour and one frame, sigma 0.35 bins of colour",
    }
    scores = [(shown, score) for shown in ("none", "grey") for score in ("J", "F")]
    rows = ((text, *(f"{{texture/{name}/{shown}/{score}}}" for shown, score in scores)) for name, text in texts.items())
    return [("histograms of", "J", "Fu", "J without colour", "Fu"), *rows]


def _local_colours() -> Rows:
    texts = {
        "fast": "`--quality fast`",
        "default": "default",
        "best": "`--quality best`",
        "no-network": "`--set motion_network.use=never`",
    }
    sides = ("local-colours/without/{0}", "local-colours/with/{0}")
    rows = (
        (text, *(f"{{{side.format(name)}/{score}}}" for side in sides for score in ("J", "F")))
        for name, text in texts.items()
    )
    return [("", "J without", "Fu", "J with", "Fu"), *rows]


def _flow_search() -> Rows:
    texts = {
        "before": "427 px, patches 3 px apart, 8 iterations, 2 of the refinement (before)",
        "zero": "the same, with no motion as a candidate",
        "iterations": "25 iterations",
        "coarse": "25 iterations, coarse search on 107 px",
        "coarse_stride_4": "25 iterations, coarse search on 107 px, patches 4 px apart",
        "side_640": "640 px, patches 4 px apart, 8 iterations, 2 of the refinement",
        "side_640_coarse": "640 px, patches 4 px apart, 25 iterations, 2 of the refinement, coarse search on 160 px",
        "side_640_stride_5": "**640 px, patches 5 px apart, 16 iterations, 1 of the refinement, coarse search on"
        " 107 px (now)**",
        "side_854": "854 px, patches 5 px apart, 8 iterations, 1 of the refinement",
        "fine": "854 px, patches 3 px apart, 25 iterations, 5 of the refinement (`flow.preset=fine`)",
    }
    untimed = {"zero", "side_640"}
    scores = [(frames, score) for frames in ("all", "second") for score in ("J", "F")]
    rows = [
        (
            text,
            *(f"{{flow-search/davis/{name}/{frames}/{score}}}" for frames, score in scores),
            "" if name in untimed else f"{{flow-search/davis/{name}/ms:.0f}}",
        )
        for name, text in texts.items()
    ]
    composed = (
        "flow put together from that of all frames",
        "",
        "",
        *(f"{{flow-search/davis/composed/second/{score}}}" for score in ("J", "F")),
        "",
    )
    head = ("grid and effort of the search", "J", "Fu", "J, every second frame", "Fu", "ms a search")
    return [head, *rows, composed]


def _parts_of_learning() -> Rows:
    texts = {
        "no-network": "`--set motion_network.use=never`",
        "default": "default",
        "best": "`--quality best`",
    }
    return [
        ("", "J", "Fu"),
        *((text, f"{{davis-{name}/fused/J}}", f"{{davis-{name}/fused/F}}") for name, text in texts.items()),
    ]


def _confidence() -> Rows:
    cells = [
        [f"{{confidence/{name}/curve/{index}/{key}}}" for name in ("sure", "complete") for key in ("expected", "true")]
        for index in range(1, 9)
    ]
    head = ("`sure`, percent", "precision, percent", "`complete`, percent", "recall, percent")
    return [head, *map(tuple, cells)]


def _peers() -> Rows:
    texts = {
        "moseg": "`moseg`, `--quality default`",
        "flow-layers": "expectation maximisation over quadratic flow models",
        "gaussian-background": "mixture of Gaussians on registered frames",
        "frame-difference": "difference of registered frames",
        "flow-threshold": "threshold on the flow's residual",
    }
    form = {"J": ":.1f", "Fu": ":.1f", "seconds_a_frame": ":.2f", "ratio": ":.2f"}
    rows = (
        (
            text,
            *(
                f"{{{data}/methods/{name}/{figure}{form[figure]}}}"
                for data in ("peers-davis", "peers-synthetic")
                for figure in form
            ),
        )
        for name, text in texts.items()
    )
    columns = ("J", "Fu", "s per frame", "ratio")
    return [("", *(f"{each}, {data}" for data in ("DAVIS", "synthetic") for each in columns)), *rows]


TABLES = {
    "readme": [
        ("data", "", "Pu", "Ru", "Fu", "J"),
        ("eight sequences of DAVIS-2016", "fused, number of motions found", *scores_of("davis-default")),
        (
            "{synthetic-residual-auto/sequences:d} synthetic scenes",
            "fused, number of motions found",
            *scores_of("synthetic-residual-auto"),
        ),
        (
            "eleven road clips of KT3DInsMoSeg, at labelled points",
            "fused, number of motions found",
            *scores_of("roads-auto"),
        ),
    ],
    "readme-trajectories": [
        ("data", "", "misclassified trajectories"),
        ("eleven clips of KT3DMoSeg", "number of motions given", "{kt3d-gt/fused/error} %"),
        (
            "",
            "number of motions found",
            "{kt3d-auto/fused/error} % (right on {kt3d-auto/fused/num_motions_correct:.0f} % of the clips)",
        ),
    ],
    "davis": [
        ("variant", *SCORES),
        ("fused (default: motions `auto`, affinity `residual`)", *scores_of("davis-residual-auto")),
        ("fused, motions `gt`", *scores_of("davis-residual-gt")),
        ("base", *scores_of("davis-residual-auto", "base")),
    ],
    "davis-sequences": _davis_sequences(),
    "quality": [
        ("quality", "J", "Fu", "s per frame"),
        *(
            (
                f"`{quality}`",
                f"{{davis-{quality}/fused/J}}",
                f"{{davis-{quality}/fused/F}}",
                f"{{quality-times/{quality}:.2f}}",
            )
            for quality in QUALITIES
        ),
    ],
    "published": [
        ("published, without training", "ARP", "TIS", "FST", "NLC"),
        ("J", *(f"{{published/davis16/{name}}}" for name in ("ARP", "TIS", "FST", "NLC"))),
    ],
    "synthetic": _synthetic(),
    "paper-choices": _paper_choices(),
    "affinities": [
        ("", "synthetic, oracle, exact, `gt`", "synthetic, oracle, no depth, `auto`"),
        ("`residual`", "{exact-residual-gt/fused/F}", "{oracle-residual-auto/fused/F}"),
        ("`ork` (paper's clustering)", "{exact-paper-clustering/fused/F}", "{oracle-paper-clustering/fused/F}"),
    ],
    "static": _what_is_static(),
    "many-hypotheses": _many_hypotheses(),
    "many-hypotheses-J": _davis_hypotheses_j(),
    "sweeps": _sweeps(),
    "rigid-flow": _rigid_flow(),
    "held-out": _held_out(),
    "confidence": _confidence(),
    "peers": _peers(),
    "training-curve": _training_curve(),
    "network-sizes": _network_sizes(),
    "small-frames": _small_frames(),
    "texture": _texture(),
    "local-colours": _local_colours(),
    "flow-search": _flow_search(),
    "networks-on-gpu": _networks_on_gpu(),
    "learning": _parts_of_learning(),
    **trajectory_tables.TABLES,
    **road_tables.TABLES,
}
"""Head and rows of each table."""
