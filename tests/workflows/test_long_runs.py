"""A run of many calls takes memory in proportion to their number."""

import tracemalloc

from moseg.workflows.cluster.call import Call
from moseg.workflows.cluster.runners import SynchronousRunner


def _peak(num_calls):
    """Return the peak memory in bytes of a run of calls that each wait for the one before."""
    calls = [Call(f"call-{i}", _nothing, (), (f"call-{i - 1}",) if i else ()) for i in range(num_calls)]
    tracemalloc.start()
    try:
        SynchronousRunner().run(calls, lambda name, result: None)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def _nothing(*_dependencies):
    return None


def test_four_times_the_calls_take_four_times_the_memory():
    _peak(1)  # what is imported at first use
    assert _peak(800) < 6 * _peak(200)
