# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Bags in which something is hidden, flown once for all tests that read them."""

from pathlib import Path

from lta_discovery.demo import DemoEffect, fly_hidden
import pytest

DRAG = DemoEffect('linear_drag.surge', 0.04, 'N s/m')
SECONDS = 30.0


@pytest.fixture(scope='session')
def hidden_bags(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path, Path]:
    """Three flights of a GT-MAB with more drag than its file says."""
    folder = tmp_path_factory.mktemp('hidden')
    a, b, c = (fly_hidden(DRAG, 40 + k, SECONDS, folder / name) for k, name in enumerate('ABC'))
    return a, b, c
