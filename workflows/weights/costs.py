"""Seconds that networks of the published sizes take, as ``benchmarks/networks/cost.py`` measured them."""

import json
from collections.abc import Mapping
from pathlib import Path

REFERENCE = "raft-large"
LIGHT = "@light"
"""Suffix of a network that ran with the parameters of a preset's lighter networks."""
_FILE = Path(__file__).with_name("costs.json")


def read_costs() -> Mapping[str, float]:
    """Return CPU seconds of a run of each network at 854x480 on one core.

    Each is given relative to RAFT in the run of the benchmark that measured it, so that figures of different days and
    machines can be compared; the seconds are those of the machine on which RAFT's own are recorded.
    """
    measured = json.loads(_FILE.read_text(encoding="utf-8"))
    base = measured[REFERENCE]["seconds"]
    return {name: base * each["seconds"] / each["reference"] for name, each in measured.items()}
