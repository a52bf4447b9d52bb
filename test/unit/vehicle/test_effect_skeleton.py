# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The skeleton of an effect is an effect like any other."""

import importlib.util

from lta_config.compilation.extract import SourceExtract
from lta_config.errors import BadInput
from lta_model.effects.protocol import VehicleMotion
from lta_vehicle.effect_skeleton import write_skeleton
import pytest

STILL = (0.0, 0.0, 0.0)
FORWARD = VehicleMotion(STILL, (1.0, 0.0, 0.0) * 3, STILL, STILL, (0.5, 0.2, 0.1), (), (), ())


def test_it_is_an_effect_like_any_other(tmp_path):
    path, project = write_skeleton('found', tmp_path / 'found')
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    effect = module.EFFECT
    assert '=' in effect.wrench.__doc__
    assert effect.wrench((0.2,), (), FORWARD, (0.0,) * 8) == (-0.1, 0.0, 0.0, 0.0, 0.0, 0.0)
    # The kernel can take it
    assert SourceExtract().add_function(effect.wrench, 'found') == 'found_compute_wrench'
    assert 'found = "found:EFFECT"' in project.read_text(encoding='utf-8')


def test_a_folder_that_exists_is_kept(tmp_path):
    with pytest.raises(BadInput, match=r'exists already; give another folder with --out'):
        write_skeleton('found', tmp_path)
    assert list(tmp_path.iterdir()) == []
