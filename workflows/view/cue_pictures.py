"""Pictures of the cues of single frames, on the scales that a report of the same run has."""

from threading import Lock

from moseg.workflows.reports.content import Picture
from moseg.workflows.reports.cue_layers import CueDrawing, PlannedCue, plan_cues
from moseg.workflows.view.shown_result import ShownResult


class CuePictures:
    """The cues of a result: which there are, and a picture of each for every frame.

    Corrections change none of them, so that they are those of the first state of a result.
    """

    def __init__(self, shown: ShownResult):
        self._shown = shown
        # The frame itself is not a cue.
        self._planned: list[PlannedCue] = plan_cues(shown.view, [shown.variant])[1:]
        self._drawings: dict[int, CueDrawing] = {}
        self._lock = Lock()

    def list(self) -> list[dict]:
        """Return name, description and colour key of each cue, and whether its artifacts are stored."""
        frames = range(self._shown.num_frames)
        wanted = [set(cue.refs(frames)) for cue in self._planned]
        present = self._shown.store.present(set().union(*wanted))
        listed = []
        for number, (cue, refs) in enumerate(zip(self._planned, wanted, strict=True)):
            is_stored = refs <= present
            drawing = self._prepared(number) if is_stored else None
            listed.append(
                {
                    "name": cue.name,
                    "description": "" if drawing is None else drawing.description,
                    "hasKey": drawing is not None and drawing.key is not None,
                    "isStored": is_stored,
                }
            )
        return listed

    def key(self, number: int) -> Picture | None:
        """Return the colour key of a cue; raises IndexError if there is no such cue."""
        return self._prepared(number).key

    def draw(self, number: int, frame: int) -> Picture | None:
        """Return a cue's picture of a frame, None where it has none; raises IndexError if there is no such cue."""
        return self._prepared(number).draw(range(self._shown.num_frames)[frame])

    def _prepared(self, number: int) -> CueDrawing:
        cue = self._planned[number]
        with self._lock:
            if number not in self._drawings:
                self._drawings[number] = cue.prepare()
            return self._drawings[number]
