"""Small renders of the synthetic scenes, made once a session."""

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest

from moseg.tasks.synthetic import SCENES, render_scene
from moseg.tasks.synthetic.trace import trace_frame
from moseg.tasks.synthetic.tracks import Tracks, track_points
from moseg.tasks.synthetic.view import object_of_parts, view_at


class Outlines(NamedTuple):
    """Identities (T, height, width) and tracks of a whole sequence, without its pictures."""

    objects: np.ndarray
    tracks: Tracks


@pytest.fixture(scope="session")
def small_scene():
    """Function from a sequence's name and a number of frames to its scene at 60 x 106 px, or 64 x 212 px if wide."""

    def shrink(name, num_frames=6):
        height, width = (60, 106) if SCENES[name].width < 2 * SCENES[name].height else (64, 212)
        return SCENES[name].model_copy(update={"height": height, "width": width, "num_frames": num_frames})

    return shrink


@pytest.fixture(scope="session")
def small(small_scene):
    """Function from a sequence's name and a number of frames to its small render."""
    return cache(lambda name, num_frames=6: render_scene(small_scene(name, num_frames)))


@pytest.fixture(scope="session")
def outlines(small_scene):
    """Function from a sequence's name to the outlines of all its frames."""

    @cache
    def trace(name):
        scene = small_scene(name, SCENES[name].num_frames)
        views = [view_at(scene, t) for t in range(scene.num_frames)]
        hits = [trace_frame(view, scene.height, scene.width) for view in views]
        objects = np.stack([object_of_parts(scene)[hit.part] for hit in hits])
        return Outlines(objects, track_points(scene, views, hits))

    return trace
