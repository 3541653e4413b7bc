"""Repetitions of a picture: frames that change much less from the one before than frames beside them do."""

from moseg.tasks.repetitions.changes import find_repetitions, mean_change

__all__ = ["find_repetitions", "mean_change"]
