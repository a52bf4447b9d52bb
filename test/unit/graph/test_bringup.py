# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The launch files of lta_bringup are the shipped launches, for `ros2 launch`."""

from pathlib import Path
import runpy

from lta_graph.launches import find_launch, LAUNCH_SUFFIX, LAUNCHES

FOLDER = Path(__file__).resolve().parents[3] / 'src/lta_bringup/launch'


def test_each_shipped_launch_has_a_file_of_its_name_and_each_file_is_one():
    files = {path.name.removesuffix(LAUNCH_SUFFIX): path for path in FOLDER.glob('*.py')}
    assert files.keys() == LAUNCHES.keys()
    for name, path in files.items():
        names = runpy.run_path(str(path))
        assert names['LAUNCH'] is find_launch(name)
        assert callable(names['generate_launch_description'])
        assert f'ros2 launch lta_bringup {path.name} ' in names['__doc__']
        assert f'lta launch {name} ' in names['__doc__']
