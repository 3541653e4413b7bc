"""Tags: what is in a frame, in words."""

from moseg.tasks.tags.recognise import Tags, recognise_tags

__all__ = ["Tags", "recognise_tags"]
