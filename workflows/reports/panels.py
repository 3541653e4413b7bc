"""Panels of a report: what it shows of each sequence, gathered during the run or later."""

from collections.abc import Iterable, Sequence

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant, Variant
from moseg.store import ArtifactStore
from moseg.workflows.graph import SequenceGraph, TrajectoryGraph
from moseg.workflows.reports.clip_layers import gather_clip_pictures
from moseg.workflows.reports.content import SequencePanel
from moseg.workflows.reports.matrices import matrix_refs
from moseg.workflows.reports.missing import WhyAbsent
from moseg.workflows.reports.pictures import gather_pictures, picture_refs
from moseg.workflows.reports.variant_panels import clip_panel, clip_refs, variant_panel

NUM_FRAMES = 16
"""Frames of each sequence that a report shows by default."""
MAX_SEQUENCES = 24
"""Sequences that a report shows by default: a page with more is too large to open."""
FPS = 24.0
"""Of the video of a sequence whose frames have no times."""


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
        Reason that is given for artifacts that are not stored.

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
        """Return whether the sequence of this name is to be shown."""
        return name in self._names

    def sinks(self, graph: SequenceGraph | TrajectoryGraph) -> tuple[str, ...]:
        """Return the references that the panel of a graph's sequence reads; none where it is not to be shown."""
        if not self.shows(graph.leaves.name):
            return ()
        list_refs = clip_refs if isinstance(graph, TrajectoryGraph) else matrix_refs
        refs = [ref for variant in self._variants for ref in list_refs(graph, self._config, variant)]
        if isinstance(graph, SequenceGraph):
            refs.extend(picture_refs(graph, self._config, self._variants, self._num_frames))
        return tuple(refs)

    def gather(self, store: ArtifactStore, graph: SequenceGraph | TrajectoryGraph, fps: float | None = None) -> None:
        """Read the panel of a graph's sequence, if it is to be shown, in place of an earlier one.

        Raises
        ------
        CorruptArtifactError
            A stored artifact is damaged; one that is not stored is named in the panel.
        """
        if not self.shows(graph.leaves.name):
            return
        what, shown = (store, graph, self._config), (self._variants, self._num_frames)
        if isinstance(graph, TrajectoryGraph):
            panel = gather_clip_pictures(*what, *shown, self._why_absent)
            variants = tuple(clip_panel(*what, variant, self._why_absent) for variant in self._variants)
        else:
            panel = gather_pictures(*what, *shown, fps or FPS, self._why_absent)
            variants = tuple(
                variant_panel(*what, variant, self._why_absent, place)
                for variant in self._variants
                for place in range(len(graph.scenes))
            )
        self.found[graph.leaves.name] = panel._replace(variants=variants)


def choose_shown(names: Sequence[str], asked: Sequence[str] | None = None) -> tuple[str, ...]:
    """Return the sequences to show: those asked for, or the first ones where none are."""
    return tuple(names[:MAX_SEQUENCES]) if asked is None else tuple(dict.fromkeys(asked))
