"""Loss of a clip without labels: certain tracks, pairs of tracks, low rank of each side's tracks, and what was known.

References
----------
Karazija et al., "Learning segmentation from point trajectories", NeurIPS 2024: trailing singular values of masked
tracks as a loss. Here their squares, and tracks weighted by the root of the mask: see `_low_rank`.
"""

from typing import NamedTuple

import torch
from torch import Tensor
from torch.nn import functional

from moseg.schemas.parameters import VideoTrainingParams
from moseg.tasks.network_training.clips import Clip

_CERTAIN = 3.0  # logit of a track that is certain enough
_MIN_WHOLE = 30  # tracks through the whole window for their rank to say something
_NOISE = 7e-4  # of a track's coordinates, in longer sides of the frame: 0.3 px of the working grid
_EPSILON = 1e-4


class ClipLosses(NamedTuple):
    """Parts of the loss, without their weights."""

    targets: Tensor
    affinity: Tensor
    low_rank: Tensor
    keep: Tensor


def clip_losses(logit: Tensor, before: Tensor, clip: Clip, rank: int) -> ClipLosses:
    """Return the losses of a clip.

    Parameters
    ----------
    logit, before : float32 (frame, y, x)
        Of the network in training, and of the one that it started from; of the frame alone, without padding.
    clip : Clip
    rank : int
        Of the tracks of one motion.
    """
    values = {name: torch.from_numpy(array).to(logit.device) for name, array in clip._asdict().items()}
    tracks = track_logits(logit, values["places"], values["seen"])
    is_shown = values["seen"].any(dim=1)
    static, moving = values["static"] * is_shown, values["moving"] * is_shown
    return ClipLosses(
        _targets(tracks, static, moving),
        _affinity(tracks, values["pairs"].long(), values["alike"], values["apart"], is_shown),
        _low_rank(torch.sigmoid(tracks), values["paths"], values["whole"].long(), rank),
        keep_loss(logit, before),
    )


def weighted_sum(losses: ClipLosses, params: VideoTrainingParams) -> Tensor:
    """Return the sum of the losses by the weights of `params`."""
    return sum(getattr(params, name) * loss for name, loss in losses._asdict().items())


def keep_loss(logit: Tensor, before: Tensor) -> Tensor:
    """Return the cross-entropy of logits with the probabilities of the network before; its gradient there is 0."""
    return functional.binary_cross_entropy_with_logits(logit, torch.sigmoid(before))


def track_logits(logit: Tensor, places: Tensor, seen: Tensor) -> Tensor:
    """Return the mean logit float32 (track,) of each track over the frames in which it is seen; 0 without any."""
    at = places.transpose(0, 1)[:, :, None]
    sampled = functional.grid_sample(logit[:, None], at, padding_mode="border", align_corners=False)[:, 0, :, 0]
    weight = seen.transpose(0, 1).float()
    return (sampled * weight).sum(0) / weight.sum(0).clamp(min=1)


def _targets(tracks: Tensor, static: Tensor, moving: Tensor) -> Tensor:
    """Return the cross-entropy of the tracks whose side is known; every track counts alike.

    A track beyond `_CERTAIN` on its side has no gradient. Labels smoothed towards the opposite would: they pull most
    static pixels, of which a trained network is more certain, back towards motion. More weight of the rarer side
    would too: next to an object there are no certain tracks, so that it grows.
    """
    entropy = sum(
        certainty * functional.softplus(-(side * tracks).clamp(max=_CERTAIN))
        for certainty, side in ((static, -1), (moving, 1))
    )
    return entropy.sum() / (static + moving).sum().clamp(min=1)


def _affinity(tracks: Tensor, pairs: Tensor, alike: Tensor, apart: Tensor, is_shown: Tensor) -> Tensor:
    """Return the cross-entropy of two tracks being on one side, of probability ``p q + (1 - p) (1 - q)``."""
    first, second = torch.sigmoid(tracks[pairs]).unbind(1)
    same = (first * second + (1 - first) * (1 - second)).clamp(_EPSILON, 1 - _EPSILON)
    shown = (is_shown[pairs[:, 0]] & is_shown[pairs[:, 1]]).float()
    loss = -(alike * torch.log(same) + apart * torch.log(1 - same)) * shown
    return loss.sum() / ((alike + apart) * shown).sum().clamp(min=1)


def _low_rank(probability: Tensor, paths: Tensor, whole: Tensor, rank: int) -> Tensor:
    """Return the energy of the tracks of both sides beyond the rank of one motion, over that of all tracks at once.

    A rigid motion under an affine camera has rank 4. The ratio is 1 where all tracks have the same probability and
    never more, because the leading eigenvalues of a sum are no larger than those of its parts together: noise, which
    has any rank, favours no side. Where one motion explains everything but noise there is nothing to gain.
    """
    if len(whole) < _MIN_WHOLE or paths.shape[1] <= 2 * rank:
        return probability.sum() * 0
    mask = probability[whole]
    noise = _NOISE**2 * paths.numel()
    left = _trailing(paths, mask, rank) + _trailing(paths, 1 - mask, rank)
    return (left + noise) / (_trailing(paths, torch.ones_like(mask), rank) + noise)


def _trailing(paths: Tensor, weight: Tensor, rank: int) -> Tensor:
    """Return the sum of the squared singular values beyond `rank` of tracks float32 (track, coordinate)."""
    weighted = (paths * weight[:, None]).double()
    return torch.linalg.eigvalsh(weighted.T @ paths.double())[:-rank].clamp(min=0).sum().float()
