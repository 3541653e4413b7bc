"""Where calls run: in this process, in workers of this machine, or on a Dask cluster."""
