"""The gated propagation module, which propagates visual and identity features from frames in memory."""

from typing import NamedTuple

import torch
from torch import nn
from torch.nn import functional as F

from moseg.tasks.networks.deaot.attention import GatedPropagation, LocalGatedPropagation, SelfGatedPropagation, Window


class LayerMemory(NamedTuple):
    """Places of one or more frames in the memory of one propagation module.

    Attributes
    ----------
    keys : (batch, place, d_att)
    values : (batch, place, 2 d_model)
        The visual branch's.
    identities : (batch, place, 2 d_model)
        The identity branch's: the object at each place.
    """

    keys: torch.Tensor
    values: torch.Tensor
    identities: torch.Tensor


def extend_memory(memory: LayerMemory, frame: LayerMemory, max_frames: int) -> LayerMemory:
    """Add a frame to long-term memory; keep the first frame and the newest of the others, `max_frames` in all.

    The masks of the first frame were given, not predicted, so it is never dropped; of the others the oldest is dropped.
    The published engine keeps every frame.
    """
    num_places = frame.keys.shape[1]
    num_recent = (max_frames - 1) * num_places
    kept = []
    for old, new in zip(memory, frame, strict=True):
        first, recent = old[:, :num_places], torch.cat([old[:, num_places:], new], dim=1)
        kept.append(torch.cat([first, recent[:, max(recent.shape[1] - num_recent, 0) :]], dim=1))
    return LayerMemory(*kept)


class Projected(NamedTuple):
    """A frame projected by a module, before its objects are decided.

    Attributes
    ----------
    query : (batch, cell, d_att)
        Query to the memory, and the frame's key when it is added to the memory.
    values : (batch, cell, 2 d_model)
    gate : (batch, cell, 4 d_model)
        Of the visual and the identity values.
    identity : (batch, cell, d_model) or None
        Normalised identity branch; None in the first module, where that branch is still empty.
    """

    query: torch.Tensor
    values: torch.Tensor
    gate: torch.Tensor
    identity: torch.Tensor | None


class GatedPropagationModule(nn.Module):
    """Long- and short-term propagation, then propagation inside the frame, in two branches that share one attention.

    References
    ----------
    Yang and Yang, "Decoupling Features in Hierarchical Propagation for Video Object Segmentation", NeurIPS 2022,
    section 4.2.
    """

    def __init__(self, d_model: int, radius: int, is_first: bool):
        super().__init__()
        self.d_att = d_model // 2
        self.norm1 = nn.LayerNorm(d_model)
        self.linear_QV = nn.Linear(d_model, self.d_att + 2 * d_model)
        self.linear_U = nn.Linear(d_model, 2 * d_model)
        if is_first:
            self.linear_ID_V = nn.Linear(d_model, 2 * d_model)
        else:
            self.id_norm1 = nn.LayerNorm(d_model)
            self.linear_ID_V = nn.Linear(2 * d_model, 2 * d_model)
            self.linear_ID_U = nn.Linear(d_model, 2 * d_model)
        self.long_term_attn = GatedPropagation(d_model)
        self.short_term_attn = LocalGatedPropagation(d_model, radius)
        self.norm2 = nn.LayerNorm(d_model)
        self.id_norm2 = nn.LayerNorm(d_model)
        self.self_attn = SelfGatedPropagation(d_model)

    def project(self, visual: torch.Tensor, identity: torch.Tensor | None) -> Projected:
        """Return the frame's query, values and gates from the branches (batch, cell, d_model)."""
        visual = self.norm1(visual)
        query, values = self.linear_QV(visual).tensor_split([self.d_att], dim=-1)
        gate = F.silu(self.linear_U(visual))
        if identity is None:
            identity_gate = torch.ones_like(gate)
        else:
            identity = self.id_norm1(identity)
            identity_gate = F.silu(self.linear_ID_U(identity))
        return Projected(query, F.silu(values), torch.cat([gate, identity_gate], dim=-1), identity)

    def remember(self, frame: Projected, assigned: torch.Tensor) -> LayerMemory:
        """Return the frame's memory; `assigned` (batch, cell, d_model) embeds which object is where."""
        identity = assigned if frame.identity is None else torch.cat([frame.identity, assigned], dim=-1)
        return LayerMemory(frame.query, frame.values, F.silu(self.linear_ID_V(identity)))

    def forward(
        self,
        visual: torch.Tensor,
        identity: torch.Tensor | None,
        frame: Projected,
        long_term: LayerMemory,
        short_term: LayerMemory,
        size: tuple[int, int],
        window: Window,
    ) -> tuple[torch.Tensor, torch.Tensor]:
        """Return both branches (batch, cell, d_model) after propagation from memory and inside the frame."""
        values = torch.cat([long_term.values, long_term.identities], dim=-1)
        update = self.long_term_attn(frame.query, long_term.keys, values, frame.gate, size)
        values = torch.cat([short_term.values, short_term.identities], dim=-1)
        update = update + self.short_term_attn(frame.query, short_term.keys, values, frame.gate, size, window)
        visual_update, identity_update = update.chunk(2, dim=-1)
        visual = visual + visual_update
        identity = identity_update if identity is None else identity + identity_update
        update = self.self_attn(self.norm2(visual), self.id_norm2(identity), size)
        visual_update, identity_update = update.chunk(2, dim=-1)
        return visual + visual_update, identity + identity_update
