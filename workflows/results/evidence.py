"""Evidence behind motion groups, read for all objects of a video: affinities, residuals, support for being static."""

from collections.abc import Iterable, Iterator
from itertools import chain
from typing import NamedTuple

import numpy as np

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.store import ArtifactStore
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.results.rigid_support import read_rigid_support


class SceneEvidence(NamedTuple):
    """References of the evidence of one scene.

    Attributes
    ----------
    affinity_refs : dict of str to reference
        The affinity by motion model; empty for the variant that has none.
    residual_refs : dict of str to tuple of references
        Each section's residuals by motion model; empty where affinities come from hypotheses alone.
    rigid_refs : tuple of references
        Rigid support of each section that was compared with a rigid scene.
    """

    affinity_refs: dict[str, str]
    residual_refs: dict[str, tuple[str, ...]]
    rigid_refs: tuple[str, ...]

    def refs(self) -> tuple[str, ...]:
        """Return all references."""
        return (*self.affinity_refs.values(), *chain.from_iterable(self.residual_refs.values()), *self.rigid_refs)


def scene_evidence(graph: SequenceGraph, config: PipelineConfig, variant: Variant) -> tuple[SceneEvidence, ...]:
    """Return where the evidence of each scene is stored that a variant's motion groups come from."""
    views = config.views(variant)
    models = () if config.affinity.method == "hypotheses" else views
    return tuple(
        SceneEvidence(
            {view: scene.motions.affinity(view) for view in views},
            {model: scene.motions.residuals(model) for model in models},
            scene.rigid_supports(variant),
        )
        for scene in graph.scenes
    )


class Evidence(NamedTuple):
    """Evidence behind the motion groups of a video; between objects of different scenes there is none.

    Attributes
    ----------
    scenes : tuple of SceneEvidence
    rows : tuple of range
        Which of the video's objects, counted from 1, are those of each scene.
    """

    scenes: tuple[SceneEvidence, ...]
    rows: tuple[range, ...]

    def affinities(self, store: ArtifactStore) -> dict[str, np.ndarray]:
        """Return the affinity between objects under each motion model, float64 (k, k); NaN where unknown."""
        return {
            view: self._join(2, (store.read(scene.affinity_refs[view], "affinity") for scene in self.scenes))
            for view in self.scenes[0].affinity_refs
        }

    def residuals(self, store: ArtifactStore) -> dict[str, np.ndarray]:
        """Return the residuals under each motion model, float64 (frame pair, k, k), px²; NaN where unknown."""
        return {model: np.concatenate([*self._read_residuals(store, model)]) for model in self.scenes[0].residual_refs}

    def static_supports(self, store: ArtifactStore) -> dict[str, np.ndarray]:
        """Return the support of the objects for being static, float64 (k,): of each view, and ``rigid`` if read."""
        supports = {
            view: self._join(1, (store.read(scene.affinity_refs[view], "static_support") for scene in self.scenes))
            for view in self.scenes[0].affinity_refs
        }
        rigid = [read_rigid_support(store, scene.rigid_refs) for scene in self.scenes]
        if any(support is not None for support in rigid):
            supports["rigid"] = self._join(1, rigid)
        return supports

    def _read_residuals(self, store: ArtifactStore, model: str) -> Iterator[np.ndarray]:
        """Yield the residuals of each section, for all objects of the video."""
        for scene, rows in zip(self.scenes, self.rows, strict=True):
            index = np.array([0, *rows])
            for ref in scene.residual_refs[model]:
                values = store.read(ref, "residual")
                spread = np.full((len(values), self._num_objects, self._num_objects), np.nan)
                spread[:, index[:, None], index] = values
                yield spread

    def _join(self, num_axes: int, scenes: Iterable[np.ndarray | None]) -> np.ndarray:
        """Return values for all objects of the video, from those of each scene's objects along each axis."""
        joined = np.full((self._num_objects,) * num_axes, np.nan)
        for values, rows in zip(scenes, self.rows, strict=True):
            if values is not None:
                joined[np.ix_(*[[0, *rows]] * num_axes)] = values
        return joined

    @property
    def _num_objects(self) -> int:
        """Objects of the video, the background included."""
        return self.rows[-1].stop
