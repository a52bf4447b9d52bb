# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Run the tests of a package where pytest is called in its folder, as `colcon test` does.

test/package_tests.py is the table of them.
"""

from pathlib import Path
import sys
from xml.etree import ElementTree

import pytest

sys.path.append(str(Path(__file__).parent / 'test'))

from package_tests import list_tests


def pytest_configure(config: pytest.Config) -> None:
    """Replace the folder of a package by its tests."""
    folder = config.invocation_params.dir.resolve()
    manifest = folder / 'package.xml'
    if config.args == [str(folder)] and manifest.is_file():
        package = ElementTree.parse(manifest).findtext('name', '')
        config.args = [str(path) for path in list_tests(package)]
