"""Stages of the graph: adapters between stored artifacts and the pure functions of `moseg_tasks`."""
