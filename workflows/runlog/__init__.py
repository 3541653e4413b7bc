"""The log of a run: its events, and the status that is read from them."""
