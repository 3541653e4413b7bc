"""Time: the graph, its execution on Dask, data sets, evaluation and the command line."""
