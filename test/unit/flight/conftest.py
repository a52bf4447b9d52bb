# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Batches of flights, as Python and compiled."""

from lta_flight.batch import fly
from numba.core import config
import pytest


@pytest.fixture(params=['plain', pytest.param('compiled', marks=pytest.mark.long)])
def batches(request, monkeypatch):
    """
    Fly batches by one text, as Python and compiled; return which.

    It takes minutes to compile. Only short flights can be flown without.
    """
    made = fly._compile_kernel.__wrapped__

    def plain(*words):
        with monkeypatch.context() as while_loading:
            while_loading.setattr(config, 'DISABLE_JIT', 1)
            return made(*words)

    if request.param == 'plain':
        monkeypatch.setattr(fly, '_compile_kernel', plain)
    return request.param
