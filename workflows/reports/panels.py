"""Panels: what a report shows of each sequence, gathered while the run that made it has it at hand, or later."""

from collections.abc import Iterable, Sequence

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant, Variant
from moseg.store import ArtifactStore
from moseg.workflows.graph import SequenceGraph, TrajectoryGraph
from moseg.workflows.reports.clip_panels import clip_panel, clip_refs
from moseg.workflows.reports.content import SequencePanel
from moseg.workflows.reports.matrices import matrix_refs
from moseg.workflows.reports.missing import WhyAbsent
from moseg.workflows.reports.pictures import gather_clip_pictures, gather_pictures, picture_refs
from moseg.workflows.reports.variant_panels import variant_panel

NUM_FRAMES = 16
"""Frames of each sequence that a report shows unless the user says otherwise."""
MOST_SEQUENCES = 24
"""Sequences that a report shows unless the user names some: a page of more is too large to open."""
FPS = 24.0
"""Of the video of a sequence whose frames say nothing of time."""


class Panels:
    """The panels of some sequences of a run; pictures are held encoded, whatever the number of waves.

    Parameters
    ----------
    config : PipelineConfig
    variants : sequence of Variant, or of TrajectoryVariant
    names : iterable of str
        The sequences to show.
    num_frames : int
        Frames of each.
    why_absent : WhyAbsent
        What to say of artifacts that are not stored.

    Attributes
    ----------
    found : dict of str to SequencePanel
    """

    def __init__(
        self,
        config: PipelineConfig,
        variants: Sequence[Variant] | Sequence[TrajectoryVariant],
        names: Iterable[str],
        num_frames: int = NUM_FRAMES,
        why_absent: WhyAbsent = WhyAbsent.GONE,
    ):
        self._config = config
        self._variants = tuple(variants)
        self._names = frozenset(names)
        self._num_frames = num_frames
        self._why_absent = why_absent
        self.found: dict[str, SequencePanel] = {}

    def shows(self, name: str) -> bool:
        """Whether the sequence of this name is to be shown."""
        return name in self._names

    def sinks(self, graph: SequenceGraph | TrajectoryGraph) -> tuple[str, ...]:
        """References that the panel of a graph's sequence is read from; none where it is not to be shown."""
        if not self.shows(graph.leaves.name):
            return ()
        if isinstance(graph, TrajectoryGraph):
            return tuple(ref for variant in self._variants for ref in clip_refs(graph, self._config, variant))
        refs = [ref for variant in self._variants for ref in matrix_refs(graph, self._config, variant)]
        return (*refs, *picture_refs(graph, self._config, self._variants, self._num_frames))

    def gather(self, store: ArtifactStore, graph: SequenceGraph | TrajectoryGraph, fps: float | None = None) -> None:
        """Read the panel of a graph's sequence, if it is to be shown, in place of an earlier one.

        Raises
        ------
        CorruptArtifactError
            A stored artifact is damaged; one that is not stored is told in the panel.
        """
        if not self.shows(graph.leaves.name):
            return
        what = store, graph, self._config
        if isinstance(graph, TrajectoryGraph):
            pictures = gather_clip_pictures(*what, self._variants, self._num_frames, self._why_absent)
        else:
            pictures = gather_pictures(*what, self._variants, self._num_frames, fps or FPS, self._why_absent)
        make = clip_panel if isinstance(graph, TrajectoryGraph) else variant_panel
        variants = tuple(make(*what, variant, self._why_absent) for variant in self._variants)
        self.found[graph.leaves.name] = SequencePanel(graph.leaves.name, variants=variants, **pictures._asdict())


def choose_shown(names: Sequence[str], asked: Sequence[str] | None = None) -> tuple[str, ...]:
    """The sequences to show: those asked for, or the first ones where none are."""
    return tuple(names[:MOST_SEQUENCES]) if asked is None else tuple(dict.fromkeys(asked))
