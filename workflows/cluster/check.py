"""Check that the processes of a cluster run the same code as this one and have its packages, before they get work."""

import sys
from collections.abc import Iterable, Mapping
from typing import Any

from distributed import Client

from moseg.schemas.errors import InputError
from moseg.workflows.cluster.process_facts import process_facts


class ClusterCheck:
    """A check of each process of a cluster, done once.

    Other code is refused, because no key would distinguish its results. Other versions of libraries are only reported:
    every artifact names those that made it, a store that lives for years holds results of many, and a user who cannot
    change a cluster's image must still be able to work on it.

    Attributes
    ----------
    unresponsive : set of str
        Addresses of late workers that cannot answer: they end when they are given work, which others then do.
    """

    def __init__(self, client: Client):
        self._client = client
        self.unresponsive: set[str] = set()
        self._own = process_facts()
        self._checked: set[str] = set()
        self._reported: set[str] = set()

    def check_scheduler(self) -> None:
        """Raise InputError unless the scheduler, which unpacks what it passes on, has the same code."""
        where = f"scheduler {self._client.scheduler.address}"
        try:
            found = self._client.run_on_scheduler(process_facts)
        except OSError:
            raise
        except Exception as error:
            found = error
        self._refuse(where, found)

    def check_workers(self, addresses: Iterable[str]) -> list[str]:
        """Return the workers that were not checked before; raise InputError if one of them cannot be given work."""
        return self._accept(self._request_facts(addresses))

    def check_late_workers(self, addresses: Iterable[str]) -> list[str]:
        """Check workers that join a run; one that cannot answer is reported and left out, not refused."""
        found = self._request_facts(addresses)
        for address, fact in found.items():
            if isinstance(fact, Exception):
                self.unresponsive.add(address)
                got = " ".join(str(fact).split())
                text = f"moseg: no moseg, or another version of it, in worker {address}, others do its work; got {got}"
                print(text, file=sys.stderr)
        return self._accept({address: fact for address, fact in found.items() if address not in self.unresponsive})

    def forget_workers(self) -> None:
        """Have the next check include all workers again."""
        self._checked.clear()
        self.unresponsive.clear()

    def _request_facts(self, addresses: Iterable[str]) -> dict[str, Any]:
        """Return the facts of each worker that was not checked before, or the exception that it answered with."""
        new = sorted(set(addresses) - self._checked - self.unresponsive)
        if not new:
            return {}
        # A worker that has ended in the meantime gives an OSError; it can do no harm.
        found = self._client.run(process_facts, workers=new, on_error="return")
        return {address: fact for address, fact in found.items() if not isinstance(fact, OSError)}

    def _accept(self, facts: Mapping[str, Any]) -> list[str]:
        for address, fact in facts.items():
            self._refuse(f"worker {address}", fact)
        self._report_versions({address: fact["versions"] for address, fact in facts.items()})
        self._checked.update(facts)
        return list(facts)

    def _refuse(self, where: str, found: Any) -> None:
        if isinstance(found, Exception):
            # The process cannot import the function that was sent; Dask passes on the reason as text.
            expected = "the same moseg on the scheduler and on every worker"
            raise InputError("no moseg, or another version of it", where=where, got=found, expected=expected) from found
        refuse_other_code(where, found["fingerprint"], self._own["fingerprint"])
        if found["missing"]:
            expected = f"the packages of moseg in the Python of that {where.partition(' ')[0]}"
            raise InputError(f"no package {found['missing']}", where=where, got="not installed", expected=expected)

    def _report_versions(self, versions: Mapping[str, Mapping[str, str]]) -> None:
        """Print, once, the libraries of which workers have other versions."""
        found: dict[str, list[str]] = {}
        for address, theirs in sorted(versions.items()):
            for name in sorted(theirs.keys() | self._own["versions"].keys()):
                here, there = (of.get(name, "none") for of in (self._own["versions"], theirs))
                if here != there:
                    found.setdefault(f"{name} {there} (here {here})", []).append(address)
        new = {text: addresses for text, addresses in found.items() if text not in self._reported}
        self._reported.update(new)
        if new:
            texts = "; ".join(f"{text} on {_name_some(addresses)}" for text, addresses in new.items())
            print(f"moseg: workers have other libraries, digits may differ: {texts}", file=sys.stderr)


def refuse_other_code(where: str, got: str, expected: str) -> None:
    """Raise InputError unless the fingerprint `got` is the one expected."""
    if got != expected:
        expected = (
            f"code {expected}, as here: install the same moseg there and restart it, it keeps the code that it loaded"
        )
        raise InputError("another version of moseg", where=where, got=f"code {got}", expected=expected)


def _name_some(addresses: list[str]) -> str:
    return addresses[0] if len(addresses) == 1 else f"{addresses[0]} and {len(addresses) - 1} more"
