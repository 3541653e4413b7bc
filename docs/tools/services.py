"""Services that commands of the documents use: an S3 server and a Dask cluster on this machine, started on demand."""

import logging
import os
import threading
from pathlib import Path
from urllib.request import Request, urlopen

BUCKET = "my-bucket"


class Services:
    """Services that start when the first command needs them, and all end with the block.

    Parameters
    ----------
    folder : Path
        Folder for the files of the services.
    """

    def __init__(self, folder: Path):
        self._folder = folder
        self._lock = threading.Lock()
        self._server = None
        self._address = ""
        self._cluster = None

    def __enter__(self) -> "Services":
        return self

    def __exit__(self, *_) -> None:
        if self._server is not None:
            self._server.stop()
        if self._cluster is not None:
            self._cluster.close()

    def environ(self, command: str) -> dict[str, str]:
        """Return the variables with which a command that names an object store finds the server; none for others."""
        if "s3://" not in command and " URL" not in command:
            return {}
        with self._lock:
            if self._server is None:
                self._start_server()
        keys = {"AWS_ACCESS_KEY_ID": "docs", "AWS_SECRET_ACCESS_KEY": "docs", "AWS_REGION": "us-east-1"}
        return {**keys, "AWS_ENDPOINT_URL": self._address, "NO_PROXY": "127.0.0.1"}

    def scheduler(self) -> str:
        """Return the address of a scheduler with one worker."""
        with self._lock:
            if self._cluster is None:
                from distributed import LocalCluster

                self._folder.mkdir(exist_ok=True)
                self._cluster = LocalCluster(
                    n_workers=1,
                    threads_per_worker=1,
                    dashboard_address=":0",
                    local_directory=str(self._folder),
                )
        return self._cluster.scheduler_address

    def _start_server(self) -> None:
        from moto.server import ThreadedMotoServer

        logging.getLogger("werkzeug").setLevel(logging.ERROR)
        os.environ.setdefault("NO_PROXY", "127.0.0.1")
        self._server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
        self._server.start()
        host, port = self._server.get_host_and_port()
        self._address = f"http://{host}:{port}"
        with urlopen(Request(f"{self._address}/{BUCKET}", method="PUT")):
            pass
