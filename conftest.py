"""Under `colcon test`, which calls pytest in the folder of each package, run the package's tests."""

from pathlib import Path
import sys
from xml.etree import ElementTree

import pytest

ROOT = Path(__file__).resolve().parent
sys.path.append(str(ROOT / 'test'))

from package_tests import list_tests


def pytest_configure(config: pytest.Config) -> None:
    folder = config.invocation_params.dir.resolve()
    manifest = folder / 'package.xml'
    if config.args == [str(folder)] and manifest.is_file():
        package = ElementTree.parse(manifest).findtext('name', '')
        config.args = [str(path) for path in list_tests(package)]
        config.option.markexpr = config.option.markexpr or 'not long and not benchmark'
