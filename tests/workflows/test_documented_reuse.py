"""The example of what is reused says in docs/caching.md what its commands print."""

import re
import shlex
from pathlib import Path

DOCUMENT = Path(__file__).parents[2] / "docs" / "caching.md"
EXAMPLE = re.compile(r"^    moseg (?P<words>(?:eval|plan) --dataset synthetic .*?) +# (?P<end>.*)$", re.MULTILINE)


def test_the_counts_of_the_example_are_those_of_its_commands(moseg, tmp_path):
    examples = list(EXAMPLE.finditer(DOCUMENT.read_text(encoding="utf-8")))
    assert len(examples) == 3
    for example in examples:
        ran = moseg(*shlex.split(example["words"]), "--store", tmp_path / "store")
        assert ran.code == 0, ran.err
        assert example["end"] in ran.out
