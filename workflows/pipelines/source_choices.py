"""Source of the proposals of every stretch of video, chosen before the rest of the graph is written.

Without the choice, the graph would have to hold the recipes of both sources, and a run would compute both.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from moseg.schemas.configs import BY_CAMERA, PipelineConfig
from moseg.schemas.recipes import Recipe
from moseg.schemas.stretch_choice import StretchChoice
from moseg.workflows.engine.session import Session
from moseg.workflows.graph import SequenceLeaves, Stretches


class ChoiceRecipes(NamedTuple):
    """Recipes of the choices of some sequences, and the references of each sequence's stretches."""

    recipes: dict[str, Recipe]
    refs: tuple[tuple[str, ...], ...]

    @property
    def sinks(self) -> tuple[str, ...]:
        """References of all choices."""
        return tuple(ref for refs in self.refs for ref in refs)


def choice_recipes(leaves: Sequence[SequenceLeaves], config: PipelineConfig) -> ChoiceRecipes:
    """Return the recipes of the choices that a configuration leaves open; none where it names the source."""
    if config.proposal_source not in BY_CAMERA:
        return ChoiceRecipes({}, tuple(() for _ in leaves))
    writers = [Stretches(each, config) for each in leaves]
    refs = tuple(writer.choices() for writer in writers)
    return ChoiceRecipes({ref: recipe for writer in writers for ref, recipe in writer.recipes.items()}, refs)


def settle_choices(
    session: Session, leaves: Sequence[SequenceLeaves], config: PipelineConfig
) -> Sequence[SequenceLeaves]:
    """Return the leaves with the choices that the configuration leaves open, computed where they are missing."""
    written = choice_recipes(leaves, config)
    if not written.recipes:
        return leaves
    held = {ref for each in leaves for ref in each.refs()}
    settled = session.settle(written.recipes, written.sinks, held)
    return with_choices(leaves, config, written, dict(zip(written.sinks, settled, strict=True)))


def with_choices(
    leaves: Sequence[SequenceLeaves],
    config: PipelineConfig,
    written: ChoiceRecipes,
    attributes: Mapping[str, Mapping],
) -> list[SequenceLeaves]:
    """Return the leaves with the choices whose attributes are known, by reference."""
    found = []
    for each, refs in zip(leaves, written.refs, strict=True):
        # Where the source is named there is nothing to pair.
        stretches = Stretches(each, config).stretches[: len(refs)]
        choices = tuple(
            StretchChoice(first_frame=stretch.start, last_frame=stretch.stop - 1, **attributes[ref])
            for stretch, ref in zip(stretches, refs, strict=True)
            if ref in attributes
        )
        found.append(each._replace(choices=choices))
    return found
