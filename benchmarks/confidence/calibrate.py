"""Calibrate how sure and how complete objects are: expected against true precision and recall of their masks.

    python benchmarks/confidence/calibrate.py --davis /data/DAVIS --store /data/store --json confidence.json

Fits the offsets and slopes of `ConfidenceParams` on the synthetic scenes, and on DAVIS-2016 if its root is given. Each
sequence has the same weight. The printed curve is of values that were predicted by a fit without their sequence.
"""

import argparse
import json
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from observations import Observation, observe
from scipy.optimize import minimize

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import ConfidenceParams
from moseg.workflows.datasets import open_dataset
from moseg.workflows.engine.session import open_session

BINS = 8
LEAST = 0.005
FIGURES = {"sure": ("inside", "precision"), "complete": ("enclosed", "recall")}
"""Evidence and truth of each figure."""


class Cases(NamedTuple):
    """Evidence and truth of one figure, and each case's sequence and weight."""

    evidence: np.ndarray
    truth: np.ndarray
    sequence: np.ndarray
    weight: np.ndarray


def main() -> None:
    """Observe, fit and report."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--davis", help="root of DAVIS, whose 2016 sequences are added")
    parser.add_argument("--store", help="artifact store; a temporary one by default")
    parser.add_argument("--json", type=Path, help="file for the figures")
    options = parser.parse_args()
    roots = {"synthetic": None} | ({"davis16": options.davis} if options.davis else {})
    observations = []
    with (
        tempfile.TemporaryDirectory() as folder,
        open_session(options.store or f"{folder}/store", quiet=True) as session,
    ):
        for name, root in roots.items():
            dataset = open_dataset(name, root, max_side=PipelineConfig().max_side)
            for sequence in dataset.names:
                observations += observe(session, dataset.sequence(sequence))
    result = {name: report(name, select(observations, *fields)) for name, fields in FIGURES.items()}
    if options.json:
        sequences = len({each.sequence for each in observations})
        how = f"benchmarks/confidence/calibrate.py on {' and '.join(roots)}, {sequences} sequences"
        content = {"name": "confidence", "provenance": "measured apart", "how": how, "result": result}
        options.json.write_text(json.dumps(content, indent=1) + "\n")


def select(observations: list[Observation], evidence: str, truth: str) -> Cases:
    """Return the cases whose truth is known; all those of a sequence weigh as much as those of another."""
    known = [each for each in observations if np.isfinite(getattr(each, truth))]
    sequence = np.array([each.sequence for each in known])
    count = {name: np.count_nonzero(sequence == name) for name in np.unique(sequence)}
    weight = np.array([1 / count[name] for name in sequence])
    return Cases(*(np.array([getattr(each, name) for each in known]) for name in (evidence, truth)), sequence, weight)


def fit(cases: Cases) -> np.ndarray:
    """Return offset and slope of the logistic curve of most likelihood."""
    features = _features(cases.evidence)

    def loss(coefficients):
        value = features @ coefficients
        return np.sum(cases.weight * (np.logaddexp(0, value) - cases.truth * value))

    return minimize(loss, np.array([0.0, 1.0])).x


def predict_apart(cases: Cases) -> np.ndarray:
    """Return each case's expected value by a fit to the other sequences."""
    expected = np.empty(len(cases.truth))
    for name in np.unique(cases.sequence):
        own = cases.sequence == name
        others = Cases(*(column[~own] for column in cases))
        expected[own] = _curve(cases.evidence[own], fit(others))
    return expected


def report(name: str, cases: Cases) -> dict:
    """Print and return the curve, the error and the fit of a figure."""
    offset, slope = fit(cases)
    expected = predict_apart(cases)
    defaults = ConfidenceParams()
    by_default = _curve(cases.evidence, [getattr(defaults, f"{name}_{part}") for part in ("offset", "slope")])
    error_of_defaults = np.average(np.abs(by_default - cases.truth), weights=cases.weight)
    error = np.average(np.abs(expected - cases.truth), weights=cases.weight)
    mean = np.average(cases.truth, weights=cases.weight)
    constant = np.average(np.abs(mean - cases.truth), weights=cases.weight)
    print(f"{name}: offset {offset:.2f}, slope {slope:.2f}; {len(cases.truth)} masks")
    print(f"  mean absolute error {100 * error:.1f} % (always the mean: {100 * constant:.1f} %)")
    print(f"  of the default parameters: {100 * error_of_defaults:.1f} %")
    order = np.argsort(expected)
    curve = []
    for part in np.array_split(order, BINS):
        pair = [np.average(values[part], weights=cases.weight[part]) for values in (expected, cases.truth)]
        curve.append({"expected": 100 * pair[0], "true": 100 * pair[1], "masks": len(part)})
        print(f"  expected {100 * pair[0]:5.1f} %  true {100 * pair[1]:5.1f} %")
    figures = {"offset": offset, "slope": slope, "error": 100 * error, "error_of_mean": 100 * constant}
    figures["error_of_defaults"] = 100 * error_of_defaults
    return {**figures, "masks": len(cases.truth), "curve": {str(index): each for index, each in enumerate(curve, 1)}}


def _curve(evidence: np.ndarray, coefficients: Sequence[float]) -> np.ndarray:
    return 1 / (1 + np.exp(-_features(evidence) @ coefficients))


def _features(evidence: np.ndarray) -> np.ndarray:
    bounded = np.clip(evidence, LEAST, 1 - LEAST)
    return np.column_stack([np.ones(len(bounded)), np.log(bounded / (1 - bounded))])


if __name__ == "__main__":
    main()
