"""Tables of trajectories without images."""

from measured_data import DATA
from measurements import COUNTS
from table_cells import Rows

_SIZES = (
    *(f"{count} frames" for count in (2, 5, 25, 100, 1000)),
    "1000 frames, short tracks",
    *(f"{count} tracks" for count in (1000, 3000, 10000, 20000)),
)


def _trajectories() -> Rows:
    given = {
        "energy, affine + homography + fundamental (default)": "kt3d-gt",
        "energy, homography + fundamental": "kt3d-gt-two-views",
        "energy, with trifocal tensors too": "kt3d-gt-four-views",
        "co-regularised, homography + fundamental": "kt3d-gt-coregularised-two-views",
        "co-regularised, all three": "kt3d-gt-coregularised-three-views",
        "kernel addition, all three (`sum`)": "kt3d-gt-sum-three-views",
    }
    rows = [(text, f"{name}/fused") for text, name in given.items()]
    alone = {"fundamental": "trajs", "homography": "homography", "affine": "affine"}
    rows += [(f"{text} alone", f"kt3d-gt/{variant}") for text, variant in alone.items()]
    return [
        ("number of motions given", "mean", "median", "spread over seeds"),
        *((text, *(f"{{{path}/{name}}}" for name in ("error", "median_error", "spread"))) for text, path in rows),
    ]


def _counts() -> Rows:
    names = {"default (`energy`; video: `threshold`)": ("kt3d-auto", "oracle-residual-auto")}
    names |= {f"`{count}`": (f"kt3d-auto-{count}", f"oracle-residual-{count}") for count in COUNTS}
    rows = (
        (text, f"{{{clips}/fused/num_motions_correct:.0f}}", f"{{{clips}/fused/error}}", f"{{{video}/fused/F}}")
        for text, (clips, video) in names.items()
    )
    return [("", "clips with the right number, percent", "error", "Fu on video"), *rows]


def _other_seeds() -> Rows:
    return [
        ("seed", "error, number given", "error, number found", "clips with the right number, percent"),
        *(
            (
                str(seed),
                f"{{kt3d-gt-seed-{seed}/fused/error}}",
                f"{{kt3d-auto-seed-{seed}/fused/error}}",
                f"{{kt3d-auto-seed-{seed}/fused/num_motions_correct:.0f}}",
            )
            for seed in (5, 6, 7)
        ),
    ]


def _data_sets() -> Rows:
    texts = {"hopkins155": "Hopkins155", "mtpv62": "MTPV62", "hopkins12": "Hopkins12", "kt3d": "KT3DMoSeg"}
    rows = [
        (
            f"{text}, {len(DATA.get(name, DATA['kt3dmoseg']).sequences)} sequences",
            *(f"{{{name}-gt/fused/{score}:.2f}}" for score in ("error", "median_error", "spread")),
            *(f"{{{name}-auto/fused/{score}:.2f}}" for score in ("error", "spread")),
            f"{{{name}-auto/fused/num_motions_correct:.0f}}",
        )
        for name, text in texts.items()
    ]
    group = "two and three motions"
    as_in_papers = (
        f"of these, {{hopkins155-gt/fused/num_sequences@{group}:d}} that papers report",
        *(f"{{hopkins155-gt/fused/{score}@{group}:.2f}}" for score in ("error", "median_error")),
        "–",
        f"{{hopkins155-auto/fused/error@{group}:.2f}}",
        "–",
        f"{{hopkins155-auto/fused/num_motions_correct@{group}:.0f}}",
    )
    rows.insert(1, as_in_papers)
    given = ("number given", "median", "spread over seeds")
    return [("wrong trajectories, percent", *given, "number found", "spread over seeds", "right number"), *rows]


def _trajectory_sizes() -> Rows:
    rows = []
    for name in _SIZES:
        numbers = ("num_tracks:d", "num_frames:d", "length:d", "seconds", "peak_mib:.0f", "error", "num_motions:d")
        rows.append(tuple(f"{{trajectory-sizes/{name}/{number}}}" for number in numbers))
    head = ("trajectories", "frames", "of each", "seconds", "peak, MiB", "error", "motions found, of 3")
    return [head, *rows]


def _trajectory_speed() -> Rows:
    motions = {"gt": "number given", "auto": "number found"}
    texts = motions | {f"whole-{key}": f"{text}, with stand-ins" for key, text in motions.items()}
    units = ("sequences:d", "seconds", "cpu", "two", "ratio:.2f")
    rows = [(text, *(f"{{trajectory-speed/hopkins155-{key}/{unit}}}" for unit in units)) for key, text in texts.items()]
    head = ("Hopkins155", "sequences", "seconds", "of the processor", "with two workers", "times faster")
    return [head, *rows]


TABLES = {
    "trajectories": _trajectories(),
    "trajectory-sets": _data_sets(),
    "trajectory-counts": _counts(),
    "trajectory-seeds": _other_seeds(),
    "trajectory-sizes": _trajectory_sizes(),
    "trajectory-speed": _trajectory_speed(),
}
