"""What a run found, read from the store."""
