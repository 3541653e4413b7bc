"""J: the Jaccard index of DAVIS, read off the overlaps of one frame."""

from collections.abc import Collection

from moseg.tasks.metrics.overlaps import Overlaps


def region_similarity(overlaps: Overlaps, true_labels: Collection[int], predicted_labels: Collection[int]) -> float:
    """Intersection over union of a true and a predicted mask in one frame, 1 where both are empty.

    Parameters
    ----------
    overlaps : Overlaps
        Of the frame, void pixels left out.
    true_labels, predicted_labels : collection of int
        Labels whose pixels make up either mask.

    References
    ----------
    Perazzi et al., "A Benchmark Dataset and Evaluation Methodology for Video Object Segmentation", CVPR 2016.
    """
    intersection = union = 0
    for (truth, predicted), count in overlaps.items():
        in_truth, in_prediction = truth in true_labels, predicted in predicted_labels
        intersection += count * (in_truth and in_prediction)
        union += count * (in_truth or in_prediction)
    return intersection / union if union else 1.0
