"""SEA-RAFT: RAFT with a regressed first flow and few, cheap iterations (Wang, Lipson and Deng 2024)."""

from moseg.tasks.networks.sea_raft.config import MEDIUM, SMALL, SeaRaftConfig
from moseg.tasks.networks.sea_raft.network import SeaRaft, build_sea_raft

__all__ = ["MEDIUM", "SMALL", "SeaRaft", "SeaRaftConfig", "build_sea_raft"]
