"""Files of a TLS connection to a scheduler, as the command line names them."""

from typing import NamedTuple


class TlsFiles(NamedTuple):
    """PEM files of the command line; Dask's own configuration replaces those that are None."""

    ca: str | None = None
    cert: str | None = None
    key: str | None = None

    def named(self) -> dict[str, str]:
        """Return the files that are given, by option."""
        options = {f"--tls-{name}": path for name, path in self._asdict().items()}
        return {option: path for option, path in options.items() if path is not None}
