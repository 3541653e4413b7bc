"""The store on an object store."""

from moseg.store.medium_store import MediumStore
from moseg.store.remote.marker import open_prefix
from moseg.store.remote.object_files import ObjectFiles
from moseg.store.remote.requests import requests_for


class RemoteStore(MediumStore):
    """Artifacts below a URL of an object store.

    `moseg.store.remote.connection` says what the environment must provide.

    Parameters
    ----------
    url : str
        ``s3://bucket/prefix``, ``gs://…``, ``az://…`` or ``abfs://…``: a store, or with `create` an empty prefix to
        make one of. The bucket must be there.

    Raises
    ------
    InputError
        The URL, the environment or what lies there cannot be a store.
    """

    def __init__(self, url: str, create: bool = True):
        requests = requests_for(url)
        open_prefix(requests, create=create)
        super().__init__(ObjectFiles(requests))
