"""Results of a run, read from the store."""
