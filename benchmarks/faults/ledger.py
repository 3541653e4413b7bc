"""A table that grows while an experiment runs, and the laws that were broken."""


class Ledger:
    """Rows, printed as they come, and the laws that did not hold."""

    def __init__(self, *columns: str):
        self._violations: list[str] = []
        self._num_laws = 0
        print(f"| {' | '.join(columns)} |\n|{'---|' * len(columns)}", flush=True)

    def row(self, *cells: object) -> None:
        """Print one line of the table."""
        print(f"| {' | '.join(str(cell).replace('|', '/') for cell in cells)} |", flush=True)

    def require(self, case: object, law: str, holds: bool, got: object = "") -> None:
        """Record whether a law held in a case."""
        self._num_laws += 1
        if not holds:
            text = f"{case}: {law}{f'; got {got}' if got != '' else ''}"
            self._violations.append(text)
            print(f"VIOLATION {text}", flush=True)

    def close(self) -> int:
        """Print the verdict and return the exit code: 1 if a law was broken."""
        print(f"\n{self._num_laws} checks, {len(self._violations)} violations")
        for text in self._violations:
            print(f"- {text}")
        return 1 if self._violations else 0
