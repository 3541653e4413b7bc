"""Bytes: the content-addressed artifact store."""
