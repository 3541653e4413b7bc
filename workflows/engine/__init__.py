"""Run a graph: sessions, planning, phases, execution, ingest."""
