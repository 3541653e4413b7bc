"""Parameters of the pipeline: their list, configuration files, presets, and messages about them."""
