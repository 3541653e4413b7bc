"""The first mask of an object as the authors of SAM 2 and EdgeTAM use it."""

import torch
from torch.nn import functional

from moseg.tasks.networks.frame_tensor import IMAGENET


class FirstMaskAsByAuthors:
    """Mixin of the video networks of transformers 5.23, which treat a given mask otherwise than the authors.

    transformers takes the object's pointer from the best of three masks and stores the given mask unchanged in memory.
    The authors take the pointer from the single mask, and store the given mask resampled from a quarter of its size.
    """

    normalisation = IMAGENET

    def given_mask(self, mask: torch.Tensor) -> torch.Tensor:
        """Return a mask in 0..1, float (1, 1, y, x) at the frame's size, as a session takes it: at the network's."""
        side = (self.image_size, self.image_size)
        return functional.interpolate(mask, size=side, mode="bilinear", antialias=True) >= 0.5

    def _single_frame_forward(self, *args, **kwargs):
        if kwargs.get("input_masks") is not None:
            kwargs.setdefault("multimask_output", False)
        return super()._single_frame_forward(*args, **kwargs)

    def _use_mask_as_output(self, *args, **kwargs):
        found = super()._use_mask_as_output(*args, **kwargs)
        side = (self.image_size, self.image_size)
        found.high_res_masks = functional.interpolate(found.pred_masks, size=side, mode="bilinear")
        return found
