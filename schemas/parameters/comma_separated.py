"""Parameters with several values, which may be given as text separated by commas."""


def split_commas(value: object) -> object:
    """Split text at its commas into a tuple; return any other value unchanged."""
    return tuple(part.strip() for part in value.split(",")) if isinstance(value, str) else value


def are_different_counts(values: tuple[int, ...]) -> bool:
    """Return whether there are values, all different and at least 1."""
    return bool(values) and min(values) >= 1 and len(set(values)) == len(values)


def check_gaps(values: tuple[int, ...]) -> tuple[int, ...]:
    """Return numbers of frames between the frames of a pair; raise ValueError unless they are different."""
    if not are_different_counts(values):
        raise ValueError("different numbers of frames from 1 on, separated by commas")
    return values


def are_names(values: tuple[str, ...]) -> bool:
    """Return whether there are values, none of them blank."""
    return bool(values) and all(value.strip() for value in values)
