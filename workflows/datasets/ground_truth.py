"""What kind of ground truth the sequences of a run have."""

from collections.abc import Sequence

from moseg.schemas.errors import InputError
from moseg.schemas.scores import GroundTruth
from moseg.workflows.datasets.dataset import SequenceSource


def find_ground_truth(sources: Sequence[SequenceSource]) -> GroundTruth:
    """'pixels' where every sequence has annotated masks, 'points' where every one has labelled points instead.

    Raises
    ------
    InputError
        A sequence without ground truth; or sequences of both kinds, whose scores have no common mean.
    """
    over = {source.name: _kind(source) for source in sources}
    points = [name for name, kind in over.items() if kind == "points"]
    if points and len(points) < len(over):
        masks = [name for name, kind in over.items() if kind == "pixels"]
        raise InputError(
            "ground truth of two kinds, which have no common mean",
            got=f"masks for {', '.join(masks)} and only labelled points for {', '.join(points)}",
            expected="sequences of one kind (--sequences)",
        )
    return "points" if points else "pixels"


def _kind(source: SequenceSource) -> GroundTruth:
    if source.annotations is not None:
        return "pixels"
    if source.labelled_points is not None:
        return "points"
    raise InputError("no ground truth to score against", where=f"sequence {source.name}")
