"""Agreement of Grounding DINO by transformers, as our kernel runs it, with the authors' code.

Run ``python benchmarks/agreement/grounding_dino.py --official DIR``, DIR being a checkout of
IDEA-Research/GroundingDINO; torchvision and timm are not needed. Both load the same random weights, of the published
widths with fewer layers, and get the same frames and names. It prints the largest differences of the words' logits and
of the boxes as shares of their spread, and those of the authors' own if the frame changes in the last digit.

Last come boxes, scores and names, from frames of other sizes on: by their transform, ``predict`` and the suppression of
the demo that runs RAM before it.

Both use BERT by transformers as the text encoder; the authors' code makes its masks and positions.
"""

import argparse
import importlib
import re
import sys
import types
import warnings
from pathlib import Path

import cv2
import numpy as np
import torch
import torchvision_parts
from PIL import Image
from torch.nn import init
from transformers import BertConfig, BertModel, GroundingDinoConfig

from moseg.schemas.parameters.grounding_dino import GroundingDinoParams
from moseg.tasks.detections import detect_objects
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.frame_tensor import frame_tensor
from moseg.tasks.networks.grounding_dino import GroundingDino, build_grounding_dino
from moseg.workflows.weights.tiny.grounding_dino import make_grounding_dino

BAR = 1e-3
NUM_LAYERS, NUM_QUERIES = 3, 100
TAGS = ("a dog", "tennis ball", "person", "zebra crossing")
SIZES = ((128, 192), (192, 160))
FRAMES = ((240, 427), (120, 160))
IMAGENET = ([0.485, 0.456, 0.406], [0.229, 0.224, 0.225])
# The authors' names of tensors to those of transformers, applied one after the other.
NAMES = (
    (r"^bert\.model\.", "model.text_backbone."),
    (r"^feat_map", "model.text_projection"),
    (r"^input_proj", "model.input_proj_vision"),
    (r"^backbone\.0\.", "model.backbone.conv_encoder.model."),
    (r"model\.patch_embed\.proj", "model.embeddings.patch_embeddings.projection"),
    (r"model\.patch_embed\.norm", "model.embeddings.norm"),
    (
        r"conv_encoder\.model\.norm(\d)",
        lambda found: f"conv_encoder.model.hidden_states_norms.stage{int(found[1]) + 1}",
    ),
    (r"conv_encoder\.model\.layers", "conv_encoder.model.encoder.layers"),
    (r"(blocks\.\d+)\.norm1", r"\1.layernorm_before"),
    (r"(blocks\.\d+)\.norm2", r"\1.layernorm_after"),
    (r"(blocks\.\d+)\.attn\.proj", r"\1.attention.output.dense"),
    (r"(blocks\.\d+)\.attn\.", r"\1.attention.self."),
    (r"(blocks\.\d+)\.mlp\.fc1", r"\1.intermediate.dense"),
    (r"(blocks\.\d+)\.mlp\.fc2", r"\1.output.dense"),
    (r"^transformer\.encoder\.layers\.(\d)", r"model.encoder.layers.\1.deformable_layer"),
    (r"^transformer\.encoder\.text_layers\.(\d)", r"model.encoder.layers.\1.text_enhancer_layer"),
    (r"^transformer\.encoder\.fusion_layers\.(\d)", r"model.encoder.layers.\1.fusion_layer"),
    (r"(deformable_layer)\.norm1", r"\1.self_attn_layer_norm"),
    (r"(deformable_layer)\.norm2", r"\1.final_layer_norm"),
    (r"(text_enhancer_layer)\.norm1", r"\1.layer_norm_before"),
    (r"(text_enhancer_layer)\.norm2", r"\1.layer_norm_after"),
    (r"gamma_v", "vision_param"),
    (r"gamma_l", "text_param"),
    (r"layer_norm_v\.", "layer_norm_vision."),
    (r"layer_norm_l\.", "layer_norm_text."),
    (r"(fusion_layer\.attn\.(?:\w+_)?)v_proj", r"\1vision_proj"),
    (r"(fusion_layer\.attn\.(?:\w+_)?)l_proj", r"\1text_proj"),
    (r"^transformer\.decoder\.norm", "model.decoder.layer_norm"),
    (r"^transformer\.decoder\.ref_point_head", "model.decoder.reference_points_head"),
    (r"^transformer\.decoder\.", "model.decoder."),
    (r"cross_attn", "encoder_attn"),
    (r"catext_norm", "encoder_attn_text_layer_norm"),
    (r"ca_text", "encoder_attn_text"),
    (r"(decoder\.layers\.\d)\.norm1", r"\1.encoder_attn_layer_norm"),
    (r"(decoder\.layers\.\d)\.norm2", r"\1.self_attn_layer_norm"),
    (r"(decoder\.layers\.\d)\.norm3", r"\1.final_layer_norm"),
    (r"linear1", "fc1"),
    (r"linear2", "fc2"),
    (r"^transformer\.enc_out_bbox_embed", "model.encoder_output_bbox_embed"),
    (r"^transformer\.tgt_embed", "model.query_position_embeddings"),
    (r"^transformer\.", "model."),
)
# Derived from sizes, not used, or duplicates under another name, because all layers share one box head.
LEFT_OUT = r"relative_position_index|pooler|position_ids|^transformer\.decoder\.bbox_embed|^bbox_embed\.[1-9]"
JOINED = ("qkv.", "in_proj_")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--official", type=Path, required=True, help="checkout of IDEA-Research/GroundingDINO")
    folder = parser.parse_args().official
    torch.set_num_threads(1)
    warnings.simplefilter("ignore")
    torch.manual_seed(0)
    text = BertConfig(hidden_size=96, num_hidden_layers=NUM_LAYERS, num_attention_heads=4, intermediate_size=128)
    files = make_grounding_dino(0).files
    config = GroundingDinoConfig(
        text_config=text.to_dict(), encoder_layers=NUM_LAYERS, decoder_layers=NUM_LAYERS, num_queries=NUM_QUERIES
    )
    documents = {
        "config.json": config.to_json_string(),
        "vocab.txt": files["vocab.txt"].decode(),
        "preprocessor_config.json": '{"size": {"shortest_edge": 1, "longest_edge": 1}}',
    }
    modules = import_official(folder)
    official = build_official(modules, BertModel(text))
    detector = build_grounding_dino(Checkpoint("random", our_names(official.state_dict()), documents))
    official.tokenizer = detector.tokenizer
    agrees = True
    print(f"{'frame':10} {'logits':>9} {'boxes':>9} {'one ulp':>9} {'one ulp':>9}")
    for height, width in SIZES:
        frame = random_frame(height, width)
        # The side limits are set so that the frame is not resized.
        found = run_ours(detector._replace(shorter_side=min(height, width), longer_side=max(height, width)), frame)
        with torch.inference_mode():
            pixels = frame_tensor(frame, (height, width), torch.device("cpu"))
            wanted, nudged = (
                official(image, captions=[", ".join(TAGS) + "."])
                for image in (pixels, pixels * (1 + torch.finfo(pixels.dtype).eps))
            )
        # Positions after the text have logits of minus infinity.
        is_word = wanted["pred_logits"].isfinite()
        is_same_text = bool((found.logits.isfinite() == is_word).all())
        pairs = (
            (found.logits[is_word], wanted["pred_logits"][is_word]),
            (found.pred_boxes, wanted["pred_boxes"]),
            (nudged["pred_logits"][is_word], wanted["pred_logits"][is_word]),
            (nudged["pred_boxes"], wanted["pred_boxes"]),
        )
        figures = [((a - b).abs().max() / b.std()).item() for a, b in pairs]
        print(f"{width}x{height:<6}", *(f"{figure:9.1e}" for figure in figures), flush=True)
        agrees &= is_same_text and max(figures[:2]) <= BAR
    for height, width in FRAMES:
        agrees &= compare_frames(modules, official, detector, random_frame(height, width))
    return 0 if agrees else 1


def random_frame(height: int, width: int) -> np.ndarray:
    frame = cv2.GaussianBlur(np.random.default_rng(0).normal(size=(height, width, 3)), (0, 0), 3)
    return (127 + 600 * frame).clip(0, 255).astype(np.uint8)


def compare_frames(modules, official: torch.nn.Module, detector: GroundingDino, frame: np.ndarray) -> bool:
    """Compare boxes, scores and names from the frame on, at half of the published input size; return if they agree."""
    transforms = modules.transforms
    prepare = transforms.Compose(
        [transforms.RandomResize([400], max_size=667), transforms.ToTensor(), transforms.Normalize(*IMAGENET)]
    )
    pixels, _ = prepare(Image.fromarray(frame), None)
    caption = ", ".join(TAGS)
    _, every, _ = modules.predict(official, pixels, caption, 0.0, 1.0, device="cpu")
    # Half of the boxes pass, half of their words name them.
    box_threshold = (every.median() + every[every > every.median()].min()).item() / 2
    boxes, scores, names = modules.predict(official, pixels, caption, box_threshold, box_threshold, device="cpu")
    size = torch.tensor([frame.shape[1], frame.shape[0]]).repeat(2)
    boxes = boxes * size
    boxes[:, :2] -= boxes[:, 2:] / 2
    boxes[:, 2:] += boxes[:, :2]
    kept = torchvision_parts.keep_best(boxes, scores, 0.5)
    names = [" ".join(re.sub(r"[,.]|\[SEP\]", " ", names[index]).split()) for index in kept]
    params = GroundingDinoParams(box_threshold=box_threshold, text_threshold=box_threshold)
    found = detect_objects(detector._replace(shorter_side=400, longer_side=667), frame, TAGS, params)
    head = f"{frame.shape[1]}x{frame.shape[0]:<6}"
    if len(found.boxes) != len(kept):
        print(f"{head} end to end: {len(found.boxes)} boxes instead of {len(kept)}", flush=True)
        return False
    differences = [np.abs(found.boxes - boxes[kept].numpy()).max(), np.abs(found.scores - scores[kept].numpy()).max()]
    num_named = sum(name0 == name1 for name0, name1 in zip(found.tags, names, strict=True))
    print(
        f"{head} end to end: {len(boxes)} boxes of {len(every)} pass, {len(kept)} are kept; boxes differ by "
        f"{differences[0]:.1e} px, scores by {differences[1]:.1e}; {num_named} names are the same",
        flush=True,
    )
    return differences[0] <= 0.1 and differences[1] <= BAR and num_named == len(kept)


def run_ours(detector: GroundingDino, frame: np.ndarray):
    """Return the network's output in our kernel."""
    outputs = []
    with detector.model.register_forward_hook(lambda _module, _inputs, output: outputs.append(output)):
        detect_objects(detector, frame, TAGS, GroundingDinoParams())
    return outputs[0]


def stand_in(name: str, folder: Path | None = None, **attributes) -> None:
    """Return a module of these attributes; a package if it has a folder."""
    module = types.ModuleType(name)
    module.__path__ = [str(folder)] if folder else []
    vars(module).update(attributes)
    sys.modules[name] = module
    parent, _, last = name.rpartition(".")
    if parent in sys.modules:
        setattr(sys.modules[parent], last, module)


def import_official(folder: Path) -> types.SimpleNamespace:
    """Import their modules of the network and its configuration alone, because their packages import more."""
    torchvision_parts.stand_in()
    vars(sys.modules["torchvision"]).update(__version__="0.20", _is_tracing=lambda: False)
    for name in ("torchvision.models", "timm", "timm.models", "supervision"):
        stand_in(name)
    sys.modules["torchvision.ops"].box_convert = None
    sys.modules["supervision"].Detections = None
    stand_in("torchvision.ops.boxes", nms=None, box_area=None)
    stand_in("torchvision.models._utils", IntermediateLayerGetter=None)
    pair = {"to_2tuple": lambda side: (side, side), "trunc_normal_": init.trunc_normal_}
    # Stochastic depth is the identity outside training.
    stand_in("timm.models.layers", DropPath=torch.nn.Identity, **pair)
    package = folder / "groundingdino"
    for name in ("", ".util", ".datasets", ".models", ".models.GroundingDINO"):
        stand_in(f"groundingdino{name}", package.joinpath(*name.split(".")))
    stand_in("groundingdino.util.visualizer", COCOVisualizer=None)
    stand_in("groundingdino.util.slconfig", SLConfig=None)
    sys.modules["groundingdino.models"].build_model = None
    stand_in("groundingdino.util.get_tokenlizer", get_tokenlizer=lambda _: _Tokenizer())
    return types.SimpleNamespace(
        network=importlib.import_module("groundingdino.models.GroundingDINO.groundingdino"),
        config=importlib.import_module("groundingdino.config.GroundingDINO_SwinT_OGC"),
        transforms=importlib.import_module("groundingdino.datasets.transforms"),
        predict=importlib.import_module("groundingdino.util.inference").predict,
    )


class _Tokenizer:
    """Tokenizer with the tokens that separate names, which the constructor of their network reads."""

    def convert_tokens_to_ids(self, tokens: list[str]) -> list[int]:
        return [{"[CLS]": 101, "[SEP]": 102, ".": 1012, "?": 1029}[token] for token in tokens]


class _Text(torch.nn.Module):
    """BERT with given masks and positions; their wrapper of it needs an older transformers."""

    def __init__(self, bert_model: BertModel):
        super().__init__()
        self.model, self.config = bert_model, bert_model.config

    def forward(self, input_ids, token_type_ids, attention_mask, position_ids) -> dict[str, torch.Tensor]:
        embeddings = self.model.embeddings(
            input_ids=input_ids, token_type_ids=token_type_ids, position_ids=position_ids
        )
        is_hidden = ~attention_mask[:, None].bool()
        added = is_hidden * torch.finfo(embeddings.dtype).min
        return {"last_hidden_state": self.model.encoder(embeddings, attention_mask=added)[0]}


def build_official(modules: types.SimpleNamespace, text: BertModel) -> torch.nn.Module:
    """Return their network with nonzero random weights."""
    sys.modules["groundingdino.util.get_tokenlizer"].get_pretrained_language_model = lambda _: text
    modules.network.get_tokenlizer.get_pretrained_language_model = lambda _: text
    modules.network.BertModelWarper = _Text
    fewer = {"enc_layers": NUM_LAYERS, "dec_layers": NUM_LAYERS, "num_queries": NUM_QUERIES, "device": "cpu"}
    plain = {"use_checkpoint": False, "use_transformer_ckpt": False}
    network = modules.network.build_groundingdino(types.SimpleNamespace(**vars(modules.config) | fewer | plain))
    for name, value in network.named_parameters():
        if re.search(r"bbox_embed.*layers\.2", name):
            init.normal_(value, std=0.05)
        elif "gamma" in name:
            init.uniform_(value, 0.3, 1)
        elif re.search("sampling_offsets|attention_weights", name):
            init.normal_(value, std=0.3)
        elif value.ndim == 1 and "norm" in name.lower() and name.endswith("weight"):
            init.uniform_(value, 0.5, 1.5)
        elif value.ndim == 1:
            init.normal_(value, std=0.1)
        elif "relative_position_bias_table" in name:
            init.normal_(value)
    return network.eval().requires_grad_(False)


def our_names(state: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    tensors = {}
    for name, value in state.items():
        if re.search(LEFT_OUT, name):
            continue
        for pattern, replacement in NAMES:
            name = re.sub(pattern, replacement, name)
        joined = next((part for part in JOINED if part in name), None)
        if joined:
            for kind, values in zip(("query", "key", "value"), value.chunk(3), strict=True):
                tensors[name.replace(joined, kind + ".")] = values
        else:
            tensors[name] = value
    return tensors


if __name__ == "__main__":
    sys.exit(main())
