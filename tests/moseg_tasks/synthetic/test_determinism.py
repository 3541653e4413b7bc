"""The same scene has the same bytes in every process."""

import subprocess
import sys
from pathlib import Path

from moseg.schemas.digests import digest_array
from moseg.tasks.synthetic import render_scene

SCRIPT = """
from moseg.tasks.synthetic import SCENES, render_scene
from moseg.schemas.digests import digest_array
scene = SCENES["deforming"].model_copy(update={"height": 60, "width": 106, "num_frames": 6})
print(*(digest_array("array", array) for array in render_scene(scene)))
"""


def digests(scene):
    return [digest_array("array", array) for array in render_scene(scene)]


def test_two_processes_render_the_same_bytes(small_scene):
    root = Path(__file__).parents[3]
    output = subprocess.run([sys.executable, "-c", SCRIPT], cwd=root, capture_output=True, text=True, check=True)
    assert output.stdout.split() == digests(small_scene("deforming"))


def test_a_longer_render_starts_with_the_shorter_one(small_scene):
    short, long = render_scene(small_scene("pan", 4)), render_scene(small_scene("pan", 6))
    assert (short.images == long.images[:4]).all()
    assert (short.flow_backward == long.flow_backward[:3]).all()


def test_seed_changes_noise_and_points_but_no_geometry(small_scene):
    scene = small_scene("pan", 2)
    first, second = render_scene(scene), render_scene(scene.model_copy(update={"seed": 1}))
    assert (first.flow_forward == second.flow_forward).all() and (first.objects == second.objects).all()
    assert (first.images != second.images).any()
