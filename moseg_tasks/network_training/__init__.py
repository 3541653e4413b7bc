"""Training of the motion network: batches, augmentation, losses, the optimizer's step, validation. Needs torch."""
