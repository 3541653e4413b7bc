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
    """Identities (T, 60, 106) and tracks of a whole sequence, without its pictures."""

    objects: np.ndarray
    tracks: Tracks


@pytest.fixture(scope="session")
def small_scene():
    """Function from a sequence's name and a number of frames to its scene at 60 x 106 px."""

    def shrink(name, num_frames=6):
        return SCENES[name].model_copy(update={"height": 60, "width": 106, "num_frames": num_frames})

    return shrink


@pytest.fixture(scope="session")
def small(small_scene):
    """Function from a sequence's name and a number of frames to its render at 60 x 106 px."""
    return cache(lambda name, num_frames=6: render_scene(small_scene(name, num_frames)))


@pytest.fixture(scope="session")
def outlines(small_scene):
    """Function from a sequence's name to the outlines of all its 24 frames."""

    @cache
    def trace(name):
        scene = small_scene(name, 24)
        views = [view_at(scene, t) for t in range(24)]
        hits = [trace_frame(view, 60, 106) for view in views]
        objects = np.stack([object_of_parts(scene)[hit.part] for hit in hits])
        return Outlines(objects, track_points(scene, views, hits))

    return trace
