"""The pins of a run: a lease on the artifacts that it works on, and its results."""

import math
import time
from collections.abc import Iterable, Sequence

from moseg.schemas.digests import digest_json
from moseg.schemas.errors import StoreError
from moseg.store import ArtifactStore

LEASE_SECONDS = 7 * 86_400.0
"""Time for which `gc` spares the artifacts of a run in progress if the run dies without ending its lease."""

RENEW_LEASE_SECONDS = 0.5 * 86_400.0
"""Age from which a lease is renewed: `gc` takes a lease that is older than a day for that of a run that died."""

RENEWED_SECONDS = 600.0
"""Age from which the pin of results that are used again gets a new time, by which `gc --older` decides."""


class RunPins:
    """The pins by which `gc` spares what a run needs.

    Attributes
    ----------
    results : dict of str to None
        Names of the pins of finished work, in their order.
    """

    def __init__(self, store: ArtifactStore, run_id: str):
        self._store = store
        self._run_id = run_id
        self._leased: frozenset[str] = frozenset()
        self._renew_at = math.inf
        self.results: dict[str, None] = {}

    def lease(self, refs: Iterable[str]) -> None:
        """Protect these artifacts, in place of those that were leased before."""
        leased = frozenset(refs)
        self._store.pin(self._run_id, leased, lease_seconds=LEASE_SECONDS)
        self._leased = leased
        self._renew_at = time.monotonic() + RENEW_LEASE_SECONDS

    def renew(self) -> None:
        """Renew the lease if it is half a day old."""
        if time.monotonic() > self._renew_at:
            self.lease(self._leased)

    def end_lease(self) -> None:
        """End the lease; results stay pinned."""
        if self._leased:
            self._store.unpin(self._run_id)
            self._leased = frozenset()

    def keep(self, refs: Sequence[str], is_new: bool, with_inputs: bool = True) -> None:
        """Pin the results of finished work, with what they were computed from, under a name that follows from them.

        If nothing is new the store may be read-only; then nothing is collected from it either, and no pin is needed. A
        damaged pin of this name is replaced.
        """
        name = digest_json("run", sorted(refs))[:16]
        try:
            found = self._store.pin_of(name)
        except StoreError:
            found = None
        if found is None or found.created < time.time() - RENEWED_SECONDS:
            # the name under which `moseg status` knows the results, also if they were only used again
            run = found.run if found is not None and not is_new else self._run_id
            try:
                self._store.pin(name, refs, run=run, with_inputs=with_inputs)
            except StoreError:
                if is_new:
                    raise
                if found is None:
                    return
        self.results[name] = None
