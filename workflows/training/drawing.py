"""Drawing of shards by worker processes."""

import multiprocessing
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from functools import lru_cache

import numpy as np

from moseg.schemas.errors import ClusterError
from moseg.workflows.process.interrupts import defer_interrupts
from moseg.workflows.process.progress import StageProgress
from moseg.workflows.process.resources import keep_freed_memory, pin_threads
from moseg.workflows.training.shards import SAMPLES, Shard

_stop = None


def draw_shards(shards: Sequence[Shard], workers: int, quiet: bool) -> None:
    """Draw those shards that are not complete.

    Parameters
    ----------
    shards : sequence of Shard
    workers : int
        Processes; 1 or fewer draws in this one.
    quiet : bool
        Whether no progress is shown.

    Raises
    ------
    InputError
        A file cannot be written.
    ClusterError
        A process ended, for example for lack of memory.
    """
    missing = [shard for shard in shards if not shard.is_complete()]
    num_samples = sum(shard.num_samples for shard in shards)
    with StageProgress({"scenes": num_samples if missing else 0}, quiet, "scenes", is_detailed=True) as progress:
        progress.advance("scenes", num_samples - sum(shard.num_samples for shard in missing))
        if min(workers, len(missing)) > 1:
            _draw_in_processes(missing, min(workers, len(missing)), progress)
            return
        for shard in missing:
            _draw(shard)
            progress.advance("scenes", shard.num_samples)


def _draw_in_processes(shards: Sequence[Shard], workers: int, progress: StageProgress) -> None:
    context = multiprocessing.get_context("spawn")
    stop = context.Event()
    with ProcessPoolExecutor(workers, context, _start_worker, (stop,)) as pool:
        with defer_interrupts():
            drawn = {pool.submit(_draw, shard): shard for shard in shards}
        try:
            for future in as_completed(drawn):
                future.result()
                progress.advance("scenes", drawn[future].num_samples)
        except BrokenProcessPool as error:
            expected = "enough memory for all, or fewer workers"
            where = f"--workers {workers}"
            raise ClusterError("a worker ended while it drew scenes", where=where, expected=expected) from error
        finally:
            # After an interruption or a failure the others end with their current scene.
            stop.set()
            pool.shutdown(cancel_futures=True)


def _start_worker(stop) -> None:
    """Prepare a worker process."""
    global _stop
    _stop = stop
    keep_freed_memory()


def _draw(shard: Shard) -> None:
    from moseg.tasks.motion_network.samples import SHAPES, draw_sample

    pin_threads(1)
    textures = _textures(shard.seed, shard.num_textures)
    # Neighbours in the order of the shards have different sizes.
    shape = SHAPES[shard.index * 7 % len(SHAPES)]
    samples = []
    for index in range(shard.index * SAMPLES, shard.index * SAMPLES + shard.num_samples):
        if _stop is not None and _stop.is_set():
            return
        samples.append(draw_sample(shard.seed, index, shape, textures))
    shard.write(*(np.stack(arrays) for arrays in zip(*samples, strict=True)))


@lru_cache(2)
def _textures(seed: int, count: int) -> np.ndarray:
    """Return the textures of a seed, painted once in a process."""
    from moseg.tasks.training_scenes import paint_textures

    return paint_textures(seed, count)
