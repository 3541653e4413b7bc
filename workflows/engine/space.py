"""Disk space: an estimate of what work will take, and whether the store's disk has it, before anything is computed."""

from collections.abc import Callable, Iterable, Mapping

from moseg.schemas.errors import InputError, MissingArtifactError
from moseg.schemas.parameters import SaliencyParams
from moseg.schemas.recipes import Recipe
from moseg.store import ArtifactStore
from moseg.workflows.process.amounts import size

BYTES_PER_PIXEL = {
    "filled_frame": 1.9,
    "flow": 1.85,
    "saliency": 2.0,
    "accumulation": 0.4,
    "motion_memory": 0.32,
    "appearance": 0.32,
    "consistency": 0.2,
    "own_motion": 0.15,
    "coherence": 0.15,
    "foreground": 0.12,
    "motion_network": 0.08,
    "depth": 3.0,
}
"""Bytes of one artifact, for each pixel of each of its frames, or of their grid; those of other tasks are small.

Measured on DAVIS at 480p with the default pipeline, like the following."""
WHOLE = 10.8
"""Bytes of all artifacts of a video, for each pixel of each frame or of its grid, while it is analysed."""
PER_FRAME, PER_VIDEO = 30_000, 2_000_000
"""Bytes of manifests and of artifacts without pixels."""
WORTH_A_LINE = 2**30
"""Bytes from which an estimate is reported."""


def video_nbytes(num_frames: int, shape: tuple[int, int]) -> float:
    """Return about how many bytes the artifacts of a video take while it is analysed; `shape` is (y, x), px."""
    return PER_VIDEO + num_frames * (PER_FRAME + WHOLE * _analysed_pixels(shape))


def plan_nbytes(store: ArtifactStore, compute: Mapping[str, Recipe]) -> float:
    """Return about how many bytes the artifacts of a plan will take; 0 if its frames are not known."""
    pixels = _num_pixels(store, compute.values())
    return pixels * sum(BYTES_PER_PIXEL.get(recipe.task, 0.0) * _num_frames(recipe) for recipe in compute.values())


def check_space(store: ArtifactStore, nbytes: float, report: Callable[[str], None]) -> None:
    """Report what work will take if it is much; raises InputError if the store's disk does not have it."""
    free = store.free_nbytes()
    if free is None:
        return
    if nbytes > free:
        expected = f"about {size(round(nbytes))}: --store on another disk, or `moseg store gc`"
        raise InputError("too little space on the disk", where=store.url, got=f"{size(free)} free", expected=expected)
    if nbytes >= WORTH_A_LINE:
        report(f"about {size(round(nbytes))} of disk while it runs ({size(free)} free)")


def _num_frames(recipe: Recipe) -> int:
    """Return the frames of one artifact: as many as the longest list of its inputs has."""
    return max((len(value) for value in recipe.inputs.values() if not isinstance(value, str)), default=1)


def _analysed_pixels(shape: tuple[int, int]) -> int:
    """Return the pixels of a frame of `shape`, or of the default working grid where a small frame is enlarged to it."""
    from moseg.tasks.frame_grid import grid_shape

    grid = grid_shape(shape, SaliencyParams().working_side)
    return max(shape[0] * shape[1], grid[0] * grid[1])


def _num_pixels(store: ArtifactStore, recipes: Iterable[Recipe]) -> int:
    """Return the analysed pixels of a frame that the recipes read; 0 if none of them reads a stored one."""
    for recipe in recipes:
        for ref in recipe.input_refs():
            if ref.startswith(("frame/", "filled_frame/")):
                try:
                    height, width, _ = store.manifest(ref).array("image").shape
                except MissingArtifactError:
                    return 0
                return _analysed_pixels((height, width))
    return 0
