"""Agreement of the logits of our RAM and RAM++ with the official code. Both load one checkpoint of random weights.

    git clone https://github.com/xinyu1205/recognize-anything
    python benchmarks/agreement/ram.py --official recognize-anything [--full]

The official package requires torchvision, timm, fairscale and an old transformers. It uses little of them for tagging
(names that are imported and not used, an initialiser, a split of a batch), so that stand-ins replace them here.
"""

import argparse
import contextlib
import importlib
import io
import sys
import types
import warnings
from pathlib import Path

import numpy as np
import torch
import torchvision_parts
import transformers.modeling_utils
import transformers.pytorch_utils
from PIL import Image
from torch import nn

from moseg.schemas.parameters.ram import RamParams
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.ram import RamConfig, build_ram, build_ram_plus
from moseg.tasks.tags import recognise_tags

LARGEST_DIFFERENCE = 1e-5
DEPTHS_REDUCED = (2, 2, 2, 2)
SEED = 7


class _Tokenizer:
    """Stand-in for BERT's tokenizer, which needs a download; its length sizes embeddings that are then deleted."""

    def __call__(self, text):
        return types.SimpleNamespace(input_ids=text.split())

    def __len__(self):
        return 30524


def _stand_in(name: str, **attributes):
    """Add a module of these attributes, and its parent packages, to `sys.modules`."""
    parts = name.split(".")
    for end in range(1, len(parts) + 1):
        sys.modules.setdefault(".".join(parts[:end]), types.ModuleType(".".join(parts[:end])))
    vars(sys.modules[name]).update(attributes)


def _import_official(folder: Path) -> tuple[types.ModuleType, ...]:
    """Import the official modules of RAM and RAM++, whose factories have the modules' names, and of their images."""
    unused = dict.fromkeys(("download_cached_file", "_cfg", "PatchEmbed", "named_apply", "adapt_input_conv"))
    pair = {"to_2tuple": lambda side: side if isinstance(side, tuple) else (side, side)}
    _stand_in("timm.models.hub", **unused)
    _stand_in("timm.models.helpers", **unused)
    _stand_in("timm.models.vision_transformer", **unused)
    _stand_in("timm.models.registry", register_model=lambda model: model)
    # Stochastic depth is the identity outside training.
    _stand_in("timm.models.layers", DropPath=nn.Identity, trunc_normal_=nn.init.trunc_normal_, **pair)
    _stand_in("fairscale.nn.checkpoint.checkpoint_activations", checkpoint_wrapper=None)
    torchvision_parts.stand_in()
    _stand_in("transformers.file_utils", ModelOutput=transformers.utils.ModelOutput)

    moved = transformers.modeling_utils
    moved.apply_chunking_to_forward = transformers.pytorch_utils.apply_chunking_to_forward
    moved.prune_linear_layer = transformers.pytorch_utils.prune_linear_layer
    moved.find_pruneable_heads_and_indices = None
    base = transformers.PreTrainedModel
    # Every weight is loaded from the checkpoint, and the head's masks hide nothing.
    base.init_weights = lambda self: None
    base.get_head_mask = lambda self, head_mask, num_layers: [None] * num_layers
    base.invert_attention_mask = lambda self, mask: (1.0 - mask[:, None, None, :].float()) * -10000.0
    base.resize_token_embeddings = lambda self, count: None

    sys.path.insert(0, str(folder))
    return tuple(importlib.import_module(f"ram.{name}") for name in ("models.ram", "models.ram_plus", "transform"))


def _official_network(module: types.ModuleType, factory: str, depths: tuple[int, ...]) -> nn.Module:
    read_json = module.read_json

    def with_depths(path):
        return read_json(path) | {"depths": list(depths)}

    module.read_json, module.init_tokenizer = with_depths, lambda *_: _Tokenizer()
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            return getattr(module, factory)(image_size=384, vit="swin_l").eval()
    finally:
        module.read_json = read_json


def _randomise(network: nn.Module, rng: np.random.Generator):
    """Set weights that keep the activations' size from layer to layer and spread the logits about the thresholds."""
    for name, tensor in network.named_parameters():
        values = rng.standard_normal(tuple(tensor.shape), dtype=np.float32)
        if name.endswith("relative_position_bias_table"):
            values *= 0.5
        elif name == "reweight_scale":
            values = np.float32(2.5)
        elif name == "fc.weight":
            values *= 0.1
        elif "norm" in name.lower() and name.endswith("weight"):
            values = 1 + 0.1 * values
        elif name.endswith("bias"):
            values *= 0.1
        elif name == "label_embed":
            values *= 1 / np.sqrt(512)
        elif name == "wordvec_proj.weight":
            values *= 0.5
        else:
            values *= 1 / np.sqrt(values[0].size)
        tensor.data.copy_(torch.from_numpy(np.asarray(values)))


def compare(module: types.ModuleType, transform, build, folder: Path, depths: tuple[int, ...]) -> float:
    """Print the comparison, and return the largest difference between logits; infinite if the tags differ.

    It starts from the frame, which the official code reads by its own transform.
    """
    factory = module.__name__.rpartition(".")[2]
    rng = np.random.default_rng(SEED)
    image = rng.integers(0, 256, (60, 107, 3), dtype=np.uint8).repeat(8, 0).repeat(8, 1)
    images = transform(384)(Image.fromarray(image))[None]

    official = _official_network(module, factory, depths)
    _randomise(official, rng)
    logits = []
    official.fc.register_forward_hook(lambda _module, _inputs, output: logits.append(output.squeeze(-1)))
    with torch.inference_mode():
        official.generate_tag(images)
        # Nearly half of the tags pass: the usual threshold is a logit of 0.62.
        official.fc.bias += 0.6 - logits.pop().median()
        official_tags = official.generate_tag(images)[0][0].split(" | ")

    lists = {"tags.txt": "ram_tag_list.txt", "thresholds.txt": "ram_tag_list_threshold.txt"}
    documents = {name: (folder / "ram" / "data" / file).read_text(encoding="utf-8") for name, file in lists.items()}
    checkpoint = Checkpoint(factory, official.state_dict(), documents, {"image": {"depths": depths}})
    tagger = build(checkpoint)
    with torch.inference_mode():
        own = tagger.network(images)
    tags = recognise_tags(tagger, image, RamParams(max_tags=len(tagger.names)))
    difference = float((own - logits[0]).abs().max())
    is_same = list(tags.names) == official_tags
    spread = f"{float(logits[0].min()):.2f}..{float(logits[0].max()):.2f}"
    print(
        f"{factory:8s} depths {depths}: largest difference {difference:.1e} of {own.numel()} logits in {spread}, "
        f"{len(tags.names)} tags {'identical' if is_same else 'DIFFERENT'}",
        flush=True,
    )
    return difference if is_same else float("inf")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--official", type=Path, required=True, help="checkout of xinyu1205/recognize-anything")
    parser.add_argument("--full", action="store_true", help="all 24 blocks of the image encoder (4 GB of memory)")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    torch.set_num_threads(1)
    depths = RamConfig().image.depths if arguments.full else DEPTHS_REDUCED
    ram, ram_plus, images = _import_official(arguments.official)
    networks = ((ram, build_ram), (ram_plus, build_ram_plus))
    differences = [
        compare(module, images.get_transform, build, arguments.official, depths) for module, build in networks
    ]
    return int(max(differences) > LARGEST_DIFFERENCE)


if __name__ == "__main__":
    sys.exit(main())
