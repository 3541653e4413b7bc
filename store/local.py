"""The store on a local (or mounted) file system."""

from pathlib import Path

from moseg.store.local_files import LocalFiles
from moseg.store.marker import open_root
from moseg.store.medium_store import MediumStore


class LocalStore(MediumStore):
    """Artifacts in a folder.

    Parameters
    ----------
    root : path
        A store, or with `create` an empty or new folder to make one of.

    Raises
    ------
    StoreError
        `root` is not a store of this format, or cannot be made one.
    """

    def __init__(self, root: Path | str, create: bool = True):
        self.root = Path(root).absolute()
        open_root(self.root, create=create)
        super().__init__(LocalFiles(self.root))
