"""Tables of road scenes, of sequences in which nothing moves, and of slow motion."""

from measured_data import DATA
from measurements import ROAD_SEEDS, SENSITIVITIES
from table_cells import SCORES, VIEWS, Rows, scores_of

_DRIVES = ("drive-crossing-cyclist", "drive-oncoming-car", "drive-overtaking-car", "drive-parked-row")


def _roads() -> Rows:
    rows = [
        (variant, *scores_of("roads-auto", variant), *scores_of("roads-gt", variant)) for variant in (*VIEWS, "base")
    ]
    saliency = ("fused, from saliency alone", *scores_of("roads-saliency"), "", "", "", "")
    given = (f"{score}, `gt`" for score in SCORES)
    return [("variant", *(f"{score}, `auto`" for score in SCORES), *given), *rows, saliency]


def _road_clips() -> Rows:
    clips = DATA["kt3dmoseg"].sequences
    rows = ((clip, *(f"{{roads-auto/fused/{score}@{clip}}}" for score in SCORES.values())) for clip in clips)
    return [("clip", *SCORES), *rows]


def _road_seeds() -> Rows:
    clips = ("Seq009_Clip03", "Seq028_Clip01", "Seq038_Clip02", "Seq095_Clip01")
    names = {"0 (default)": "roads-auto"} | {seed: f"roads-seed-{seed}" for seed in ROAD_SEEDS}
    return [
        ("seed", "Fu", "J", *(f"Fu / J of {clip}" for clip in clips)),
        *(
            (
                seed,
                *scores_of(name)[2:],
                *(f"{{{name}/fused/F@{clip}}} / {{{name}/fused/J@{clip}}}" for clip in clips),
            )
            for seed, name in names.items()
        ),
    ]


def _disturbed_roads() -> Rows:
    texts = {
        "mirrored": "mirrored",
        "reversed": "reversed in time",
        "every_second": "every second frame",
        "noisy": "noise of ten grey levels",
        "compressed": "JPEG of quality 12",
        "coded": "H.264 of quality 32",
        "dark": "12 % of the light",
    }
    clips = ("Seq009_Clip01", "Seq028_clip03", "Seq009_Clip03", "Seq071_Clip01")
    undisturbed = (
        "as they are",
        *scores_of("roads-auto")[2:],
        *(f"{{roads-auto/fused/F@{clip}}}" for clip in clips),
    )
    rows = (
        (
            text,
            *(f"{{disturbed-roads/{name}/mean/{score}}}" for score in ("F", "J")),
            *(f"{{disturbed-roads/{name}/{clip}/F}}" for clip in clips),
        )
        for name, text in texts.items()
    )
    return [("clips", "Fu", "J", *(f"Fu of {clip}" for clip in clips)), undisturbed, *rows]


def _road_outlines() -> Rows:
    texts = {
        "all": "all parts",
        "plain-points": "points of plain patches followed, too",
        "wide": "pixels within 30 px of tracks, not only between them",
        "no-colours": "local colours not asked",
        "none": "none of the three",
    }
    scores = ("J", "P", "R")
    rows = (
        (text, *(f"{{road-outlines/masks/{part}/mean/{score}}}" for score in scores)) for part, text in texts.items()
    )
    return [("", *scores), *rows]


def _still(name: str, sequence: str = "") -> str:
    at = f"@{sequence}" if sequence else ""
    return f"{{{name}/fused/false_pixels{at}:.2f}} / {{{name}/fused/false_frames{at}:.0f}}"


def _road_parts() -> Rows:
    texts = {
        "auto": "all parts",
        "gap-2": "pairs 2 frames apart only",
        "gap-4": "pairs 4 frames apart only",
        "no-patch-test": "errors of tracks not limited by the patch test",
        "no-behind": "halves of a patch only explained near its track",
        "no-contact": "no test of the contact with the ground",
        "no-field": "no agreement with neighbours",
        "no-groups": "candidates not regrouped by motion",
        "no-static-parts": "parts that seem to move as the background does never kept",
        "no-following": "objects not followed where their tracks end",
        "no-outlines": "outlines not drawn along edges of the frame",
        "no-completion": "objects without the rest of their surfaces, all of them scattered",
        "no-scattering": "scattered objects asked for no more evidence",
        "no-comparison": "objects not compared with a rigid scene",
    }
    return [
        ("", "Fu", "J", "parked cars: false pixels / frames, percent", "all of `still`"),
        *(
            (
                text,
                *scores_of(f"roads-{part}")[2:],
                _still(f"still-{part}", "kitti_parked_cars"),
                _still(f"still-{part}"),
            )
            for part, text in texts.items()
        ),
    ]


def _road_curve() -> Rows:
    names = {value: f"sensitivity-{value}" for value in SENSITIVITIES} | {"1": "auto"}
    values = sorted(names, key=float)
    return [
        ("sensitivity", *SCORES, "parked cars: false pixels / frames", "all of `still`"),
        *(
            (
                value + (" (default)" if value == "1" else ""),
                *scores_of(f"roads-{names[value]}"),
                _still(f"still-{names[value]}", "kitti_parked_cars"),
                _still(f"still-{names[value]}"),
            )
            for value in values
        ),
    ]


def _still_sequences() -> Rows:
    measured = ("still-auto", "still-no-comparison", "still-tracks")
    rows = ((name, *(_still(each, name) for each in measured)) for name in DATA["still"].sequences)
    head = ("false pixels / frames, percent", "default", "not compared with a rigid scene", "`--proposals tracks`")
    return [head, *rows, ("mean", *(_still(each) for each in measured))]


def _drives() -> Rows:
    rows = (
        (name, *(f"{{synthetic-residual-auto/fused/{score}@{name}}}" for score in SCORES.values())) for name in _DRIVES
    )
    return [("scene", *SCORES), *rows]


def _frame_rates() -> Rows:
    cases = {
        "10": "frames/rate-10",
        "20": "frames/rate-20",
        "20, pairs 4 and 8 apart": "seconds/rate-20",
        "30": "frames/rate-30",
        "30, pairs 6 and 12 apart": "seconds/rate-30",
    }
    rows = ((text, *(f"{{frame-rates/{case}/{name}/J}}" for name in _DRIVES)) for text, case in cases.items())
    return [("J of drives, by frames per second", *(name.removeprefix("drive-") for name in _DRIVES)), *rows]


def _slow_motion() -> Rows:
    places = [(kind, group) for group in ("movers", "still") for kind in ("neighbours", "chosen")]
    texts = {"movers": "movers", "still": "nothing moves"}
    kinds = {"neighbours": "neighbouring frames", "chosen": "frames *n* apart"}
    head = ("times as many frames", *(f"J, {texts[group]}: {kinds[kind]}" for kind, group in places))
    rows = (
        (factor, *(f"{{slow-motion/{kind}/slower-{factor}/{group}/mean/J}}" for kind, group in places))
        for factor in ("1", "4")
    )
    return [head, *rows]


def _given_cameras() -> Rows:
    texts = {
        "tracks": "fitted to tracks; the ground in place of depth (default)",
        "tracks-depth": "fitted to tracks; exact depth",
        "tracks-depth-medium": "fitted to tracks; depth off by 10 %",
        "exact": "given, exact",
        "small": "given; off by 0.1°, 2° in direction, 3 % in length, 2 % in focal length, 5 % in depth",
        "medium": "given; off by 0.3°, 5°, 10 %, 5 %, 10 %",
        "large": "given; off by 1°, 15°, 20 %, 10 %, 15 %",
        "small-uncorrected": "given; off by 0.1° and so on, not corrected by tracks",
    }
    shares = ("movers", "static", "still")
    rows = [(text, *(f"{{given-cameras/{name}/{share}}}" for share in shares)) for name, text in texts.items()]
    return [
        ("the camera", "tracks of movers", "of static surfaces beside them", "of scenes in which nothing moves"),
        *rows,
    ]


TABLES = {
    "given-cameras": _given_cameras(),
    "roads": _roads(),
    "road-clips": _road_clips(),
    "road-seeds": _road_seeds(),
    "disturbed-roads": _disturbed_roads(),
    "road-parts": _road_parts(),
    "road-curve": _road_curve(),
    "still": _still_sequences(),
    "drives": _drives(),
    "frame-rates": _frame_rates(),
    "slow-motion": _slow_motion(),
    "road-outlines": _road_outlines(),
}
