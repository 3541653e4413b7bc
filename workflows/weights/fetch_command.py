"""The command that gets weights items."""

from moseg.schemas.weights import WeightsItem


def fetch_command(*items: WeightsItem, again: bool = False) -> str:
    """Return the command that fetches items; with `again`, also files that only their first download fixes."""
    words = ["moseg weights fetch", *(item.name for item in items)]
    words += list(dict.fromkeys(item.consent for item in items if item.consent))
    words += ["--again"] if again else []
    return " ".join(words)
