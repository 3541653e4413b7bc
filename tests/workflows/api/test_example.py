"""The example of the documentation runs as it stands."""

import subprocess
import sys
from pathlib import Path

from PIL import Image

EXAMPLE = Path(__file__).resolve().parents[3] / "docs" / "examples" / "segment_video.py"


def test_the_example_segments_a_scene(tmp_path):
    command = [sys.executable, "-W", "error", EXAMPLE]
    ran = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    assert "object 1: motion 1, frames 0 to" in ran.stdout
    assert len(list((tmp_path / "example" / "out" / "masks").iterdir())) == 10
    with Image.open(tmp_path / "example" / "figure.png") as figure:
        assert figure.width > 900
