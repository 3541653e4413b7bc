"""Plug-ins: data sets, exports, motion models and methods of stages that other packages and scripts add."""
