"""Names of objects as input texts of Grounding DINO."""

from collections.abc import Sequence
from typing import NamedTuple

from transformers import BertTokenizer

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.grounding_dino import Separator

_SIGNS: dict[Separator, str] = {"comma": ",", "stop": "."}


class Prompt(NamedTuple):
    """A text of several names, ``[CLS] a dog, tennis ball. [SEP]``.

    Attributes
    ----------
    token_ids : list of int
    tags : list of str
        The names.
    """

    token_ids: list[int]
    tags: list[str]


def compose_prompts(
    tokenizer: BertTokenizer,
    tags: Sequence[str],
    tags_per_prompt: int,
    max_tokens: int,
    separator: Separator = "comma",
) -> list[Prompt]:
    """Join the names, in lower case and without repetition, into as few texts as the limits allow.

    If one text cannot hold them all they are distributed evenly, because scores fall with the length of a text. (The
    authors' code truncates a text after 256 tokens.) A full stop or question mark within a name is removed, because it
    ends a phrase.

    Parameters
    ----------
    tokenizer : BertTokenizer
    tags : sequence of str
    tags_per_prompt, max_tokens : int
        Limits of one text.
    separator : "comma" or "stop"
        Separator of two names; a full stop always ends the text.

    Raises
    ------
    InputError
        A name has no word, a word unknown to the tokenizer, or more words than a text holds.
    """
    names = list(dict.fromkeys(" ".join(tag.lower().split()) for tag in tags))
    ends = set(tokenizer.convert_tokens_to_ids([".", "?"]))
    stop, between = tokenizer.convert_tokens_to_ids([".", _SIGNS[separator]])
    per_prompt = -(-len(names) // -(-len(names) // tags_per_prompt)) if names else 0
    prompts: list[Prompt] = []
    for name in names:
        words = [token for token in tokenizer(name, add_special_tokens=False)["input_ids"] if token not in ends]
        room = max_tokens - 3
        if not 0 < len(words) <= room or tokenizer.unk_token_id in words:
            raise InputError(
                "no known words, or too many",
                where="tags",
                got=repr(name),
                expected=f"1 to {room} of BERT's tokens",
            )
        is_full = not prompts or len(prompts[-1].tags) == per_prompt
        if is_full or len(prompts[-1].token_ids) + len(words) + 1 > max_tokens:
            prompts.append(Prompt([tokenizer.cls_token_id, stop, tokenizer.sep_token_id], []))
        token_ids, tags_of = prompts[-1]
        # Before the last full stop.
        token_ids[-2:-2] = [between, *words] if tags_of else words
        tags_of.append(name)
    return prompts
