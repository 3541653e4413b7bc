"""Cells of the tables of measured figures: each a text with ``{expression}`` for a figure."""

VIEWS = ("fused", "oc-depth", "oc", "trajs")
SCORES = {"Pu": "P", "Ru": "R", "Fu": "F", "J": "J"}
Rows = list[tuple[str, ...]]


def scores_of(name: str, variant: str = "fused") -> tuple[str, ...]:
    """Return a cell for each score of a variant."""
    return tuple(f"{{{name}/{variant}/{score}}}" for score in SCORES.values())
