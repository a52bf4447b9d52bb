"""Vehicles side by side, as Python and compiled."""

from functools import cache

from lta_sim.kernels import cpu_batch
from numba.core import config
import pytest

LOAD = cpu_batch._load_kernel.__wrapped__


@pytest.fixture(params=['plain', pytest.param('compiled', marks=pytest.mark.long)])
def steps(request, monkeypatch):
    """
    Fly by one text, as Python and compiled; return how many steps do not take long.

    It takes most of a minute to compile.
    """
    if request.param == 'compiled':
        return 200
    monkeypatch.setattr(cpu_batch, '_load_kernel', load_plain_kernel)
    return 2


@cache
def load_plain_kernel(names, zeros, rotors, width):
    """Return the kernel of a batch as Python."""
    with pytest.MonkeyPatch.context() as while_loading:
        while_loading.setattr(config, 'DISABLE_JIT', 1)
        return LOAD(names, zeros, rotors, width)
