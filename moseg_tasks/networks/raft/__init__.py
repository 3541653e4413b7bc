"""RAFT: recurrent all-pairs field transforms for optical flow (Teed and Deng 2020), large and small."""

from moseg.tasks.networks.raft.config import LARGE, SMALL, RaftConfig
from moseg.tasks.networks.raft.network import STRIDE, Raft, build_raft

__all__ = ["LARGE", "SMALL", "STRIDE", "Raft", "RaftConfig", "build_raft"]
