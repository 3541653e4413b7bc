"""Training of the motion network: scenes drawn into files by several processes, steps with checkpoints, the result."""
