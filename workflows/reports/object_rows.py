"""The moving objects of a sequence as rows of a table."""

from moseg.schemas.configs import Variant
from moseg.workflows.exports.motion_json import summarise_sequence
from moseg.workflows.reports.missing import Missing, name_absent
from moseg.workflows.reports.sequence_view import SequenceView, all_colours, as_hex
from moseg.workflows.reports.table_content import ObjectRow
from moseg.workflows.results.found_objects import found_refs, read_found_objects


def list_objects(view: SequenceView, variant: Variant, fps: float) -> tuple[tuple[ObjectRow, ...], tuple[Missing, ...]]:
    """What moves in any frame of the sequence, and what the store lacks where it cannot tell."""
    frames = range(len(view.graph.leaves.frames))
    refs = {*view.label_refs(variant, frames), *found_refs(view.graph, variant)}
    absent = refs - view.store.present(refs)
    if absent:
        return (), (name_absent("table of objects", absent),)
    found = read_found_objects(view.store, view.graph, variant)
    labels = (view.labels(variant, frame) for frame in frames)
    name = view.graph.leaves.name
    summary = summarise_sequence(name, labels, fps, found.num_motions, found.motions, found.tags)
    colours = all_colours()
    rows = tuple(
        ObjectRow(
            identity=each.identity,
            colour=as_hex(colours[each.identity]),
            motion=each.motion,
            first_frame=each.first_frame,
            last_frame=each.last_frame,
            num_frames=each.num_frames,
            mean_area_percent=100 * each.mean_area_fraction,
            tag=each.tag,
        )
        for each in summary.objects
    )
    return rows, ()
