"""Frames, ground truth and cues of a rendered scene."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np

from moseg.schemas.digests import digest_json
from moseg.schemas.spelling import unknown_name
from moseg.tasks.synthetic import SCENES, STILL_SCENES, RenderedScene, Scene, render_scene
from moseg.workflows.sources.frames import FrameDescription

RENDERER_VERSION = 1
"""Raised when `render_scene` gives other arrays for the same declaration."""


@dataclass(frozen=True)
class SceneFrames:
    """Frames of the scene of this name, at the size in which it is declared."""

    name: str

    def fingerprint(self) -> str:
        """Return the digest of the scene's declaration and the renderer's version."""
        return _fingerprint("frames", self.name)

    def read(self) -> Iterator[np.ndarray]:
        """Yield each frame as uint8 (y, x, 3) RGB."""
        yield from _rendered(find_scene(self.name)).images

    def describe(self) -> FrameDescription:
        """Return the declared size; a scene has no frame rate."""
        scene = find_scene(self.name)
        return FrameDescription((scene.height, scene.width), None)

    def num_frames(self) -> int:
        """Return the declared number."""
        return find_scene(self.name).num_frames

    def chunks(self, size: int) -> tuple["SceneFrames", ...]:
        """Return the source itself: a scene is rendered as a whole."""
        return (self,)


@dataclass(frozen=True)
class SceneMasks:
    """Identities of the scene's moving objects, or of all its objects."""

    name: str
    which: Literal["moving", "objects"] = "moving"

    def fingerprint(self) -> str:
        """Return the digest of the scene's declaration and the renderer's version."""
        return _fingerprint(self.which, self.name)

    def read(self) -> Iterator[tuple[int, np.ndarray]]:
        """Yield index and uint16 (y, x) labels of every frame."""
        yield from enumerate(getattr(_rendered(find_scene(self.name)), self.which))


@dataclass(frozen=True)
class SceneDepth:
    """Exact inverse depth of the scene."""

    name: str

    def fingerprint(self) -> str:
        """Return the digest of the scene's declaration and the renderer's version."""
        return _fingerprint("inverse_depth", self.name)

    def read(self) -> Iterator[np.ndarray]:
        """Yield float32 (y, x) of every frame, 1/m."""
        yield from _rendered(find_scene(self.name)).inverse_depth


@dataclass(frozen=True)
class SceneFlow:
    """Exact flow of the scene: item m goes from frame m to m + 1 (forward) or from m + 1 to m (backward)."""

    name: str
    direction: Literal["forward", "backward"]

    def fingerprint(self) -> str:
        """Return the digest of the scene's declaration and the renderer's version."""
        return _fingerprint(f"flow_{self.direction}", self.name)

    def read(self) -> Iterator[np.ndarray]:
        """Yield float32 (y, x, uv) of every frame pair, px/frame."""
        yield from getattr(_rendered(find_scene(self.name)), f"flow_{self.direction}")


@dataclass(frozen=True)
class SceneTracks:
    """Exact tracks of points on the scene's surfaces."""

    name: str

    def fingerprint(self) -> str:
        """Return the digest of the scene's declaration and the renderer's version."""
        return _fingerprint("tracks", self.name)

    def read(self) -> tuple[np.ndarray, np.ndarray]:
        """Return `points` float32 (track, frame, xy) px and `visible` bool (track, frame)."""
        scene = _rendered(find_scene(self.name))
        return scene.points, scene.visible


def find_scene(name: str) -> Scene:
    """Return the declaration of a scene, a static one's too; raise InputError for an unknown name."""
    scenes = SCENES | STILL_SCENES
    if name not in scenes:
        raise unknown_name("scene", name, scenes)
    return scenes[name]


@lru_cache(maxsize=1)
def _rendered(scene: Scene) -> RenderedScene:
    """Render a scene, or return the last one: the sources of a scene are read in turn and rendering takes seconds."""
    return render_scene(scene)


def _fingerprint(what: str, name: str) -> str:
    return digest_json("source", ["scene", RENDERER_VERSION, what, find_scene(name).model_dump(mode="json")])
