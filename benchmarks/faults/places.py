"""Common parts of the experiments on disks: the workload, an undisturbed store, and the laws of a refused run."""

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from contents import Contents, read_contents
from ledger import Ledger
from processes import Ended, run_to_end
from workload import MOSEG, Workload, read_counts


class Bench(NamedTuple):
    """The workload, a scratch folder, an undisturbed store with its contents, and the ledger of findings.

    With `short` only one of several similar cases is run.
    """

    workload: Workload
    folder: Path
    whole: Path
    contents: Contents
    ledger: Ledger
    short: bool = False

    @property
    def workers(self) -> tuple[int, ...]:
        """Return the numbers of worker processes to try."""
        return (0,) if self.short else (0, 2)

    def evaluate(
        self, store: Path, *options: str, before: tuple[str, ...] = (), env: Mapping[str, str] | None = None
    ) -> Ended:
        """Run the evaluation, under the command `before` if there is one."""
        command = self.workload.command("eval", str(store), self.folder / "report.json", *options)
        return run_to_end([*before, *command], self.folder / "logs", env)

    def manage(self, store: Path, *words: str, before: tuple[str, ...] = ()) -> Ended:
        """Run a command of `moseg store`."""
        return run_to_end([*before, *MOSEG, "store", *words, "--store", str(store)], self.folder / "logs")

    def require_refusal(self, case: str, ended: Ended, code: int, *words: str) -> None:
        """Check that a refused run ended with one line, with these words in it, and with this exit code."""
        law = f"one line with {', '.join(words)}; exit code {code}"
        self.ledger.require(case, law, ended.code == code and ended.is_one_line(*words), (ended.code, ended.err))

    def require_success(self, case: str, ended: Ended) -> bool:
        """Check that a run succeeded and printed nothing on standard error."""
        is_well = (ended.code, ended.err) == (0, "")
        self.ledger.require(case, "it succeeds without messages", is_well, (ended.code, ended.err))
        return is_well

    def require_whole(self, case: str, store: Path) -> Contents:
        """Check that no visible artifact is damaged, or differs from the undisturbed store."""
        found = read_contents(str(store))
        self.ledger.require(case, "stored artifacts are complete", not found.problems, found.problems)
        is_same = all(self.contents.results.get(ref) == result for ref, result in found.results.items())
        self.ledger.require(case, "stored artifacts are those of an undisturbed run", is_same)
        return found

    def require_rest(self, case: str, store: Path, before: Contents, ended: Ended) -> int:
        """Check that the continued run computed the missing artifacts and nothing else; return how many."""
        if not self.require_success(case, ended):
            return 0
        after = self.require_whole(case, store)
        computed = read_counts(ended.out)[0]
        missing = after.num_computed(before)
        self.ledger.require(case, "it computes the missing artifacts", computed == missing, f"{computed} of {missing}")
        self.ledger.require(case, "nothing is written again", not after.rewritten(before), after.rewritten(before))
        self.ledger.require(case, "all artifacts are stored", after.results == self.contents.results)
        return computed
