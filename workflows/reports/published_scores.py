"""Results that papers report, shown beside measured ones and never mixed with them."""

_METHODS = (
    "MoSeg (supervised)",
    "Raptor (supervised features)",
    "RigidMask (supervised features)",
    "EM (unsupervised)",
    "paper, fused",
    "paper, OC+depth",
    "paper, OC",
    "paper, trajs",
    "paper, base",
)


def _rows(*scores: tuple[float, float, float]) -> dict[str, tuple[float, float, float]]:
    return dict(zip(_METHODS, scores, strict=True))


PAPER_COLUMNS = ("Pu", "Ru", "Fu")
PAPER_ROWS: dict[str, dict[str, tuple[float, float, float]]] = {
    "davis-moving": _rows(
        (78.30, 78.80, 78.10),
        (75.90, 79.67, 75.93),
        (59.03, 49.89, 50.01),
        (58.42, 83.48, 64.24),
        (78.27, 81.58, 79.40),
        (71.53, 75.66, 73.18),
        (58.25, 59.22, 57.08),
        (65.99, 75.51, 68.47),
        (43.17, 86.24, 52.12),
    ),
    "ytvos-moving": _rows(
        (74.50, 66.40, 66.38),
        (64.43, 60.94, 60.35),
        (29.88, 17.88, 18.70),
        (44.52, 40.33, 37.12),
        (64.12, 61.10, 60.62),
        (63.54, 58.94, 56.06),
        (61.79, 54.64, 53.74),
        (54.67, 52.92, 50.05),
        (48.49, 73.01, 50.82),
    ),
    "kt3dinsmoseg": _rows(
        (63.73, 78.24, 66.85),
        (71.52, 88.27, 75.82),
        (65.14, 83.34, 70.91),
        (42.85, 58.71, 44.03),
        (72.93, 71.02, 71.89),
        (48.04, 61.54, 49.26),
        (36.44, 39.97, 34.78),
        (42.31, 73.66, 45.24),
        (38.97, 70.97, 43.37),
    ),
}
"""The paper's Pu, Ru and Fu by data set and method, percent, over pixels."""

PUBLISHED_CLIPS = 22
PUBLISHED_ERRORS: dict[str, tuple[float, float]] = {
    "affine": (15.4, 15.4),
    "homography": (11, 14),
    "fundamental": (14, 20),
    "all three, kernel addition": (7.7, 8.5),
    "all three, co-regularisation": (7.8, 8.7),
    "all three, subset constraint": (8, 9.5),
}
"""Least and largest error in percent with the number of motions given, over all 22 clips of KT3DMoSeg: Xu, Cheong, Li,
"Motion segmentation by exploiting complementary geometric models", CVPR 2018, and later publications and re-runs of its
code."""
ONE_MOTION_ERROR = 28.0
"""Of everything as one motion, over all 22 clips, percent."""
