"""The command that gets weights items."""

from moseg.schemas.weights import WeightsItem


def fetch_command(*items: WeightsItem, again: bool = False) -> str:
    """What to type to have items fetched; `again`: also where they are here, and only their first download counts."""
    words = ["moseg weights fetch", *(item.name for item in items)]
    words += ["--non-commercial"] if any(item.is_non_commercial for item in items) else []
    words += ["--again"] if again else []
    return " ".join(words)
