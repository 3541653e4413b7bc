"""The columns of a table of scores, on the terminal and in reports."""

from moseg.schemas.scores import GroundTruth

_COLUMNS = {
    "Pu": "P",
    "Ru": "R",
    "Fu": "F",
    "J": "J",
    "F-boundary": "boundary_F",
    "J/object": "J_objects",
    "F-b/object": "boundary_F_objects",
}


def score_columns(over: GroundTruth) -> dict[str, str]:
    """Fields of a `SequenceScore` by their heads; of boundaries points say nothing."""
    return {head: name for head, name in _COLUMNS.items() if over == "pixels" or "boundary" not in name}
