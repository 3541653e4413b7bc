"""Agreement of SAM 3 by transformers, as our kernels run it, with the authors' code.

Run ``python benchmarks/agreement/sam3.py --official DIR``, DIR being a checkout of facebookresearch/sam3; none of
torchvision, timm, iopath, ftfy and triton is needed. The image encoder, the text encoder and the input are small; the
detector and the tracker are as published. The detector's logits, boxes and masks are compared, and the objects that
either code finds by a phrase if it reads and resizes the frame itself; so are the tracker's logits and labels.
"""

import argparse
import importlib
import sys
import warnings
from pathlib import Path
from unittest import mock

import cv2
import numpy as np
import torch
from PIL import Image
from sam2_family import BAR, WIDE, Masks, double_precision, moving_discs, report
from sam3_small import SIDE, build_official, import_official, our_checkpoint, random_state

from moseg.schemas.parameters.sam3 import Sam3Params
from moseg.tasks.instances.sam3 import segment_concepts
from moseg.tasks.networks.frame_tensor import SYMMETRIC, Resizing, frame_tensor
from moseg.tasks.networks.sam3 import Sam3Detector, build_sam3_detector, build_sam3_tracker
from moseg.tasks.proposals.sam2 import track_masks_sam2

SHARE_FOUND = 0.03
PHRASES = ("person", "sports ball", "a person's red hat", "Yellow  school bus", "crème brûlée, 2 of 3")


def compare_tokens(tokenizer, detector: Sam3Detector) -> bool:
    """Return whether both codes make the same tokens of the phrases."""
    agrees = True
    for phrase in PHRASES:
        theirs = [token for token in tokenizer([phrase], context_length=32)[0].tolist() if token]
        agrees &= theirs == detector.tokenize(" ".join(phrase.lower().split()))
    print(f"tokens of {len(PHRASES)} phrases: {'the same' if agrees else 'DIFFERENT'}", flush=True)
    return agrees


def official_answer(official, pixels: torch.Tensor, phrase: str) -> dict[str, torch.Tensor]:
    """Return the authors' answer about normalised pixels."""
    stage = importlib.import_module("sam3.model.sam3_image_processor").FindStage
    none = dict.fromkeys(("input_boxes", "input_boxes_mask", "input_boxes_label", "input_points", "input_points_mask"))
    first = torch.tensor([0])
    seen = official.backbone.forward_image(pixels) | official.backbone.forward_text([phrase], device="cpu")
    return official.forward_grounding(
        seen, stage(img_ids=first, text_ids=first, **none), None, official._get_dummy_prompt()
    )


def compare_answers(official, detector: Sam3Detector, frame: np.ndarray) -> bool:
    """Return whether the detectors agree, and print how far transformers' own answer to a phrase is from theirs."""
    pixels = frame_tensor(frame, (SIDE, SIDE), torch.device("cpu"), normalisation=SYMMETRIC)
    vision = detector.model.get_vision_features(pixels)
    worst = np.zeros((3, 3))
    for phrase in PHRASES:
        wanted, nudged = (
            official_answer(official, images, phrase)
            for images in (pixels, pixels * (1 + torch.finfo(pixels.dtype).eps))
        )
        tokens = torch.tensor([detector.tokenize(phrase)])
        plain = detector.model(vision_embeds=vision, input_ids=tokens, attention_mask=torch.ones_like(tokens))
        for row, kind in enumerate(("pred_logits", "pred_boxes_xyxy", "pred_masks")):
            theirs = wanted[kind][0].squeeze(-1) if row == 0 else wanted[kind][0]
            other = nudged[kind][0].reshape(theirs.shape)
            ours = [getattr(found, kind.removesuffix("_xyxy"))[0] for found in (detector.find(vision, phrase), plain)]
            found = [(value - theirs).abs().max() / theirs.std() for value in (*ours, other)]
            worst[row] = np.maximum(worst[row], [value.item() for value in found])
    for kind, (ours, plain, nudge) in zip(("scores", "boxes", "masks"), worst, strict=True):
        print(f"detector, {kind:7} ours {ours:.1e}, transformers {plain:.1e}, one ulp {nudge:.1e}", flush=True)
    return bool((worst[:, 0] <= np.maximum(BAR, worst[:, 2])).all())


def compare_found(official, detector: Sam3Detector, frame: np.ndarray) -> bool:
    """Compare the objects if each code reads and resizes the frame itself; return whether they agree."""
    processor = importlib.import_module("sam3.model.sam3_image_processor").Sam3Processor(official, SIDE, "cpu", 0.0)
    state = processor.set_image(Image.fromarray(frame))
    # Random weights score low.
    scores = torch.cat([processor.set_text_prompt(phrase, state)["scores"] for phrase in PHRASES])
    params = Sam3Params(min_score=scores.quantile(1 - SHARE_FOUND).item())
    processor.set_confidence_threshold(params.min_score)
    same, changed, difference, num_found, num_pixels = True, 0, 0.0, 0, 0
    for phrase in PHRASES:
        wanted = processor.set_text_prompt(phrase, state)
        found = segment_concepts(detector, frame, [phrase], params)
        theirs, scores = wanted["masks"][:, 0].numpy(), wanted["scores"].numpy()
        num_found += len(theirs)
        if len(theirs) != len(found.masks):
            same = False
            continue
        changed += int(np.count_nonzero(theirs != found.masks))
        num_pixels += theirs.size
        difference = max(difference, float(np.abs(found.scores - scores).max(initial=0)))
    print(
        f"objects, end to end: {num_found} by {len(PHRASES)} phrases, {'the same' if same else 'OTHERS'}; {changed} of "
        f"{num_pixels} pixels of masks differ, scores by {difference:.1e}",
        flush=True,
    )
    return same and num_found > 0 and changed <= 1e-3 * num_pixels and difference <= 1e-3


def official_video(official, pixels: torch.Tensor, size: tuple[int, int], seeds: np.ndarray) -> Masks:
    """Return the objects tracked by the authors' predictor in normalised pixels (frame, 3, y, x)."""
    state = official.init_state(*size, len(pixels), offload_state_to_cpu=True)
    state["images"] = pixels
    for label in (1, 2):
        official.add_new_mask(state, 0, label, torch.from_numpy(seeds == label))
    labels, logits, scores = [], [], []
    for found in official.propagate_in_video(state, 0, len(pixels), False, tqdm_disable=True, propagate_preflight=True):
        _, _, small, masks, score = found
        surest, index = masks[:, 0].max(dim=0)
        labels.append(torch.where(surest > 0, index + 1, 0).numpy())
        logits.append(small[:, 0])
        scores.append(score[:, 0])
    return Masks(torch.cat(logits[1:]), torch.cat(scores[1:]), np.stack(labels)[1:])


def our_video(tracker: torch.nn.Module, frames: list[np.ndarray], seeds: np.ndarray) -> Masks:
    """Return the objects tracked by our kernel."""
    outputs = []
    with tracker.register_forward_hook(lambda _module, _inputs, output: outputs.append(output)):
        labels = track_masks_sam2(tracker, frames, seeds, Sam3Params())
    logits = torch.cat([output.pred_masks for output in outputs[1:]])[:, 0]
    return Masks(logits, torch.cat([output.object_score_logits for output in outputs[1:]])[:, 0], labels[1:])


def compare_videos(official, tracker: torch.nn.Module, frames: list[np.ndarray], seeds: np.ndarray) -> bool:
    """Return whether the trackers agree; theirs gets frames that are resized like those of a folder of theirs."""
    device = torch.device("cpu")
    pixels = [frame_tensor(frame, (SIDE, SIDE), device, Resizing.PIL_BICUBIC, SYMMETRIC) for frame in frames]
    pixels = torch.cat(pixels)
    print(f"{'':14} {'logits':>9} {'scores':>9} {'one ulp':>9} {'pixels':>8} {'one ulp':>8} {'seen':>6}")
    theirs, nudged = (
        official_video(official, images, seeds.shape, seeds)
        for images in (pixels, pixels * (1 + torch.finfo(pixels.dtype).eps))
    )
    return report("video", our_video(tracker, frames, seeds), theirs, nudged)


def compare(folder: Path) -> bool:
    """Return whether our networks agree with the authors' code in a folder."""
    builder = import_official(folder)
    state = random_state()
    official, official_tracker = build_official(builder, folder, state)
    tokenizer = official.backbone.language_backbone.tokenizer
    checkpoint = our_checkpoint(state, tokenizer)
    detector = build_sam3_detector(checkpoint)
    frames, seeds = moving_discs(16)
    frames = [cv2.resize(frame, WIDE) for frame in frames]
    seeds = cv2.resize(seeds, WIDE, interpolation=cv2.INTER_NEAREST)
    agrees = compare_tokens(tokenizer, detector)
    agrees &= compare_answers(official, detector, frames[0])
    agrees &= compare_found(official, detector, frames[0])
    return compare_videos(official_tracker, build_sam3_tracker(checkpoint), frames, seeds) and agrees


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--official", type=Path, required=True, help="checkout of facebookresearch/sam3")
    folder = parser.parse_args().official
    torch.set_num_threads(1)
    warnings.simplefilter("ignore")
    itself = {name: lambda tensor, *_, **__: tensor for name in ("cuda", "pin_memory")}
    with torch.inference_mode(), double_precision(), mock.patch.multiple(torch.Tensor, **itself):
        torch.manual_seed(0)
        return 0 if compare(folder) else 1


if __name__ == "__main__":
    sys.exit(main())
