"""RepViT, EdgeTAM's image encoder, with the tensor names of the published checkpoints.

transformers takes it from timm, which needs torchvision. Here it is a model that transformers finds by its
configuration. It is run as it was trained: the branches that could be fused for speed are separate.
"""

import torch
from torch import nn
from transformers import AutoConfig, AutoModel, PreTrainedConfig, PreTrainedModel
from transformers.modeling_outputs import BaseModelOutput

SQUEEZED, SQUEEZE_STEP = 0.25, 8
"""Channels of squeeze-and-excitation as a share of the block's, and their step."""
EXPANSION = 2


class RepVitConfig(PreTrainedConfig):
    """Channels and blocks of each stage; the defaults are those of RepViT-M1."""

    model_type = "moseg_repvit"

    def __init__(self, widths=(48, 96, 192, 384), depths=(2, 2, 14, 2), **kwargs):
        self.widths, self.depths = list(widths), list(depths)
        super().__init__(**kwargs)


class RepVit(PreTrainedModel):
    """Feature maps of four stages, at strides of 4, 8, 16 and 32 px.

    References
    ----------
    Wang et al., "RepViT: Revisiting Mobile CNN From ViT Perspective", CVPR 2024.
    """

    config_class = RepVitConfig
    main_input_name = "pixel_values"

    def __init__(self, config: RepVitConfig):
        super().__init__(config)
        self.timm_model = _Stages(config.widths, config.depths)
        self.post_init()

    def forward(self, pixel_values: torch.Tensor, **kwargs) -> BaseModelOutput:
        """Return the maps of all stages as ``last_hidden_state``, as transformers' wrapper of timm does."""
        return BaseModelOutput(last_hidden_state=self.timm_model(pixel_values))


class _Stages(nn.Module):
    def __init__(self, widths: list[int], depths: list[int]):
        super().__init__()
        self.stem = _Stem(widths[0])
        for index, (width, depth) in enumerate(zip(widths, depths, strict=True)):
            self.add_module(f"stages_{index}", _Stage(widths[index - 1] if index else None, width, depth))

    def forward(self, x: torch.Tensor) -> list[torch.Tensor]:
        stem, *stages = self.children()
        x, maps = stem(x), []
        for stage in stages:
            x = stage(x)
            maps.append(x)
        return maps


class _ConvNorm(nn.Sequential):
    def __init__(self, width_in: int, width_out: int, size: int = 1, stride: int = 1, groups: int = 1):
        super().__init__()
        self.c = nn.Conv2d(width_in, width_out, size, stride, size // 2, groups=groups, bias=False)
        self.bn = nn.BatchNorm2d(width_out)


class _Stem(nn.Module):
    def __init__(self, width: int):
        super().__init__()
        self.conv1 = _ConvNorm(3, width // 2, 3, stride=2)
        self.conv2 = _ConvNorm(width // 2, width, 3, stride=2)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return self.conv2(nn.functional.gelu(self.conv1(x)))


class _Stage(nn.Module):
    def __init__(self, width_in: int | None, width: int, depth: int):
        super().__init__()
        self.downsample = nn.Identity() if width_in is None else _Downsample(width_in, width)
        self.blocks = nn.Sequential(*(_Block(width, is_squeezed=index % 2 == 0) for index in range(depth)))

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return self.blocks(self.downsample(x))


class _Downsample(nn.Module):
    def __init__(self, width_in: int, width: int):
        super().__init__()
        self.pre_block = _Block(width_in, is_squeezed=False)
        self.spatial_downsample = _ConvNorm(width_in, width_in, 3, stride=2, groups=width_in)
        self.channel_downsample = _ConvNorm(width_in, width)
        self.ffn = _ChannelMixer(width)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        x = self.channel_downsample(self.spatial_downsample(self.pre_block(x)))
        return x + self.ffn(x)


class _Block(nn.Module):
    def __init__(self, width: int, is_squeezed: bool):
        super().__init__()
        self.token_mixer = _TokenMixer(width)
        self.se = _SqueezeExcitation(width) if is_squeezed else nn.Identity()
        self.channel_mixer = _ChannelMixer(width)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        x = self.se(self.token_mixer(x))
        return x + self.channel_mixer(x)


class _TokenMixer(nn.Module):
    """Sum of a depthwise 3x3 convolution, a depthwise 1x1 convolution and the input."""

    def __init__(self, width: int):
        super().__init__()
        self.conv = _ConvNorm(width, width, 3, groups=width)
        self.conv1 = _ConvNorm(width, width, groups=width)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return self.conv(x) + self.conv1(x) + x


class _SqueezeExcitation(nn.Module):
    def __init__(self, width: int):
        super().__init__()
        squeezed = max(SQUEEZE_STEP, int(width * SQUEEZED + SQUEEZE_STEP / 2) // SQUEEZE_STEP * SQUEEZE_STEP)
        self.fc1 = nn.Conv2d(width, squeezed, 1)
        self.fc2 = nn.Conv2d(squeezed, width, 1)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        gate = self.fc2(nn.functional.relu(self.fc1(x.mean((2, 3), keepdim=True))))
        return x * gate.sigmoid()


class _ChannelMixer(nn.Module):
    def __init__(self, width: int):
        super().__init__()
        self.conv1 = _ConvNorm(width, EXPANSION * width)
        self.conv2 = _ConvNorm(EXPANSION * width, width)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return self.conv2(nn.functional.gelu(self.conv1(x)))


AutoConfig.register(RepVitConfig.model_type, RepVitConfig)
AutoModel.register(RepVitConfig, RepVit)
