"""Whether the processes of a cluster run the same code as this one and have what it takes: asked before they work."""

import sys
from collections.abc import Iterable, Mapping
from typing import Any

from distributed import Client

from moseg.schemas.errors import InputError
from moseg.workflows.cluster.code_fingerprint import refuse_other_code
from moseg.workflows.cluster.process_facts import process_facts


class ClusterCheck:
    """Asks each process of a cluster once.

    Other code is refused, because no key would tell its results apart. Other versions of libraries are only told: every
    artifact names those that made it, a store that lives for years holds results of many, and who cannot change a
    cluster's image must still be able to work on it.

    Attributes
    ----------
    speechless : set of str
        Addresses of late workers that cannot answer: they end when they are given work, which others then do.
    """

    def __init__(self, client: Client):
        self._client = client
        self.speechless: set[str] = set()
        self._own = process_facts()
        self._checked: set[str] = set()
        self._told: set[str] = set()

    def check_scheduler(self) -> None:
        """Raise InputError where the scheduler, which unpacks what it hands on, has not the same code."""
        where = f"scheduler {self._client.scheduler.address}"
        try:
            found = self._client.run_on_scheduler(process_facts)
        except OSError:
            raise
        except Exception as error:
            found = error
        self._refuse(where, found)

    def check_workers(self, addresses: Iterable[str]) -> list[str]:
        """Those of the workers that were not asked before; raises InputError where one of them cannot be given work."""
        return self._accept(self._ask(addresses))

    def check_late_workers(self, addresses: Iterable[str]) -> list[str]:
        """The same for workers that join a run: one that cannot even answer is told of and left out, not refused."""
        found = self._ask(addresses)
        for address, fact in found.items():
            if isinstance(fact, Exception):
                self.speechless.add(address)
                got = " ".join(str(fact).split())
                text = f"moseg: no moseg, or another version of it, in worker {address}, others do its work; got {got}"
                print(text, file=sys.stderr)
        return self._accept({address: fact for address, fact in found.items() if address not in self.speechless})

    def _ask(self, addresses: Iterable[str]) -> dict[str, Any]:
        """What each worker that was not asked before says, or the exception that it gives in place of that."""
        new = sorted(set(addresses) - self._checked - self.speechless)
        if not new:
            return {}
        # A worker that has gone in the meantime gives an OSError; it can do no harm.
        found = self._client.run(process_facts, workers=new, on_error="return")
        return {address: fact for address, fact in found.items() if not isinstance(fact, OSError)}

    def _accept(self, facts: Mapping[str, Any]) -> list[str]:
        for address, fact in facts.items():
            self._refuse(f"worker {address}", fact)
        self._tell({address: fact["versions"] for address, fact in facts.items()})
        self._checked.update(facts)
        return list(facts)

    def forget_workers(self) -> None:
        """Ask all again when they are next checked."""
        self._checked.clear()
        self.speechless.clear()

    def _refuse(self, where: str, found: Any) -> None:
        if isinstance(found, Exception):
            # The question itself cannot be understood; Dask hands on the reason as text.
            expected = "the same moseg on the scheduler and on every worker"
            raise InputError("no moseg, or another version of it", where=where, got=found, expected=expected) from found
        refuse_other_code(where, found["fingerprint"], self._own["fingerprint"])
        if found["lacks"]:
            expected = f"the packages of moseg in the Python of that {where.partition(' ')[0]}"
            raise InputError(f"no package {found['lacks']}", where=where, got="not installed", expected=expected)

    def _tell(self, versions: Mapping[str, Mapping[str, str]]) -> None:
        """Name, once, the libraries of which workers have other versions."""
        found: dict[str, list[str]] = {}
        for address, theirs in sorted(versions.items()):
            for name in sorted(theirs.keys() | self._own["versions"].keys()):
                here, there = (of.get(name, "none") for of in (self._own["versions"], theirs))
                if here != there:
                    found.setdefault(f"{name} {there} (here {here})", []).append(address)
        new = {text: addresses for text, addresses in found.items() if text not in self._told}
        self._told.update(new)
        if new:
            texts = "; ".join(f"{text} on {_some(addresses)}" for text, addresses in new.items())
            print(f"moseg: workers have other libraries, digits may differ: {texts}", file=sys.stderr)


def _some(addresses: list[str]) -> str:
    return addresses[0] if len(addresses) == 1 else f"{addresses[0]} and {len(addresses) - 1} more"
