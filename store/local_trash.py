"""Artifacts moved aside on a file system, each by one rename, before they are deleted."""

import os
import shutil
from collections.abc import Collection, Iterable
from pathlib import Path

from moseg.schemas.errors import StoreError
from moseg.store.commit import new_staging
from moseg.store.file_reading import read_manifests
from moseg.store.layout import Layout


class LocalTrash:
    """A staging folder with a tree of artifacts; see `moseg.store.medium.Trash`."""

    def __init__(self, layout: Layout):
        self.taken: set[str] = set()
        self._layout = layout
        try:
            self._aside = Layout(Path(new_staging(layout)))
        except OSError as error:
            raise self._fault(error) from error

    def read_manifests(self, refs: Collection[str]) -> dict[str, bytes]:
        """Manifests of artifacts that were taken."""
        return read_manifests(self._aside, refs)

    def take(self, refs: Iterable[str]) -> None:
        """Move artifacts aside."""
        for ref in refs:
            if self._rename(self._layout.folder(ref), self._aside.folder(ref)):
                self.taken.add(ref)

    def give_back(self, refs: Iterable[str]) -> None:
        """Move artifacts back."""
        for ref in refs:
            self._rename(self._aside.folder(ref), self._layout.folder(ref))
            self.taken.discard(ref)

    def empty(self) -> None:
        """Delete the staging folder."""
        shutil.rmtree(self._aside.root, ignore_errors=True)

    def _rename(self, source: str, target: str) -> bool:
        try:
            self._layout.make_folder(os.path.dirname(target))
            os.rename(source, target)
        except OSError as error:
            # gone already, or computed again meanwhile
            if os.path.lexists(source) and not os.path.lexists(target):
                raise self._fault(error) from error
            return False
        return True

    def _fault(self, error: OSError) -> StoreError:
        return StoreError(f"cannot take artifacts out of service: {error.strerror}", where=self._layout.root)
