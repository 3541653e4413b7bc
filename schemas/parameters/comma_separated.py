"""Parameters with several values, which may be given as text separated by commas."""

_QUOTES = "\"'"


def split_commas(value: object) -> object:
    """Split text at its commas into a tuple, ``1,2`` as well as ``[1, 2]``; return any other value unchanged.

    Raises
    ------
    ValueError
        A bracket or a quote at the edge of a value has no counterpart.
    """
    if not isinstance(value, str):
        return value
    text = value.strip()
    is_list = text.startswith("[") and text.endswith("]")
    parts = [part.strip() for part in (text[1:-1] if is_list else text).split(",")]
    # As in YAML, a comma may follow the last value of a list, and values may have quotes.
    if is_list and not parts[-1]:
        parts = parts[:-1]
    return tuple(map(_unquote, parts))


def _unquote(text: str) -> str:
    if len(text) > 1 and text[0] == text[-1] and text[0] in _QUOTES:
        return text[1:-1]
    if text[:1] in ("[", *_QUOTES) or text[-1:] in ("]", '"'):
        raise ValueError("values separated by commas, without or within one pair of brackets")
    return text


def are_different_counts(values: tuple[int, ...]) -> bool:
    """Return whether there are values, all different and at least 1."""
    return bool(values) and min(values) >= 1 and len(set(values)) == len(values)


def check_gaps(values: tuple[int, ...]) -> tuple[int, ...]:
    """Return numbers of frames between the frames of a pair; raise ValueError unless they are different."""
    if not are_different_counts(values):
        raise ValueError("different numbers of frames from 1 on, separated by commas")
    return values


def check_models(values: tuple[str, ...]) -> tuple[str, ...]:
    """Return names of models; raise ValueError if there are two of one, which would count twice."""
    if len(set(values)) < len(values):
        raise ValueError("different models, separated by commas")
    return values


def are_names(values: tuple[str, ...]) -> bool:
    """Return whether there are values, none of them blank."""
    return bool(values) and all(value.strip() for value in values)
