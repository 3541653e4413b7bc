"""Models of transformers, built from a checkpoint's tensors: no path, no network, nothing left at random values."""

import json
from collections.abc import Iterator
from contextlib import contextmanager

import torch
from transformers import PreTrainedConfig, PreTrainedModel
from transformers.utils import logging

from moseg.schemas.errors import InputError
from moseg.tasks.networks.checkpoint import Checkpoint, describe_shapes, refuse_tensors

CONFIG = "config.json"


def build_transformers(
    model_class: type[PreTrainedModel],
    config_class: type[PreTrainedConfig],
    checkpoint: Checkpoint,
) -> PreTrainedModel:
    """Build a model with every tensor set from the checkpoint, in float32, evaluation mode and without gradients.

    Names of older published checkpoints are converted as in transformers. Its loader only warns of missing tensors and
    leaves them random; here that is an error.

    Parameters
    ----------
    model_class, config_class
        Classes of transformers.
    checkpoint : Checkpoint
        With ``config.json`` among its documents.

    Raises
    ------
    InputError
        There is no readable ``config.json``; or a tensor is missing, left over (but for those that the class declares
        ignorable) or of another shape: the first of them are named.
    """
    where = f"weights {checkpoint.name}"
    if not checkpoint.tensors:
        raise InputError("no tensors", where=where)
    with quiet_transformers():
        config = _read_config(config_class, checkpoint)
        try:
            model, report = model_class.from_pretrained(
                None,
                config=config,
                state_dict=dict(checkpoint.tensors),
                dtype=torch.float32,
                ignore_mismatched_sizes=True,  # reported, and refused below
                output_loading_info=True,
            )
        except RuntimeError as error:
            # Its loader raises for some shapes (of shared or converted tensors) before it reports them.
            refuse_tensors(
                "tensors of another shape", _misshapen(model_class, config, checkpoint.tensors), checkpoint.name
            )
            raise InputError("tensors do not fit the network", where=where, got=error) from error
    mismatched = [describe_shapes(*found) for found in sorted(report["mismatched_keys"])]
    refuse_tensors("tensors are missing", sorted(report["missing_keys"]), checkpoint.name)
    refuse_tensors("tensors are not the network's", sorted(report["unexpected_keys"]), checkpoint.name)
    refuse_tensors("tensors of another shape", mismatched, checkpoint.name)
    return model.eval().requires_grad_(False)


def read_json(checkpoint: Checkpoint, name: str) -> dict:
    """Return the object in one of the checkpoint's JSON documents.

    Raises
    ------
    InputError
        The document is not there or holds no JSON object.
    """
    where = f"{name} of weights {checkpoint.name}"
    document = checkpoint.document(name)
    try:
        content = json.loads(document)
    except (ValueError, RecursionError) as error:
        raise InputError("not JSON", where=where, got=error) from error
    if not isinstance(content, dict):
        raise InputError("no JSON object", where=where, got=type(content).__name__)
    return content


def _read_config(config_class: type[PreTrainedConfig], checkpoint: Checkpoint) -> PreTrainedConfig:
    content = read_json(checkpoint, CONFIG)
    try:
        return config_class.from_dict(content)
    # The errors of transformers for invalid values derive from Exception directly.
    except Exception as error:
        where = f"{CONFIG} of weights {checkpoint.name}"
        raise InputError(f"no configuration of {config_class.__name__}", where=where, got=error) from error


def _misshapen(model_class: type[PreTrainedModel], config: PreTrainedConfig, tensors) -> list[str]:
    """Describe the tensors that differ in shape from those of the same name in the model."""
    with torch.device("meta"):
        expected = model_class(config).state_dict()
    pairs = [(key, value, expected[key]) for key, value in tensors.items() if key in expected]
    return [describe_shapes(key, got.shape, wanted.shape) for key, got, wanted in pairs if got.shape != wanted.shape]


@contextmanager
def quiet_transformers() -> Iterator[None]:
    """Suppress transformers' progress bar and report, which would go to the user's terminal."""
    verbosity = logging.get_verbosity()
    hook = logging.set_tqdm_hook(lambda factory, args, kwargs: args[0])
    logging.set_verbosity(logging.CRITICAL)
    try:
        yield
    finally:
        logging.set_verbosity(verbosity)
        logging.set_tqdm_hook(hook)
