# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Run a Python file of the user, such as a strategy or a launch file."""

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
import sys
import traceback
from types import ModuleType
from typing import Final

from lta_config.errors import BadInput

PYTHON_SUFFIX: Final = '.py'


def is_strategy_file(name: str) -> bool:
    """Return whether the name of a strategy is that of a Python file."""
    return name.endswith(PYTHON_SUFFIX) or '/' in name


def run_python_file(path: Path, what: str) -> ModuleType:
    """
    Return the module of a file.

    `what`: what the file is, as in 'a strategy'. Raise `BadInput` if it cannot be run.
    """
    # A name of its own, which no installed module has: the file may be called math.py
    spec = spec_from_file_location(f'lta_file_{path.stem.replace(".", "_")}', path)
    if spec is None or spec.loader is None:
        raise BadInput(f"'{path}' cannot be imported as Python; name a file that ends in .py.")
    module = module_from_spec(spec)
    # Dataclasses of the file look their module up
    sys.modules[spec.name] = module
    try:
        # As a bag stores it
        path.read_text(encoding='utf-8')
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        raise BadInput(
            f"'{path}' cannot be run as {what}: {describe_python_error(error, path)}; correct it."
        ) from error
    return module


def describe_python_error(error: BaseException, path: Path) -> str:
    """Return kind, text and line of an error in a file."""
    frames = [
        each for each in traceback.extract_tb(error.__traceback__) if each.filename == f'{path}'
    ]
    line = (
        error.lineno if isinstance(error, SyntaxError) else frames[-1].lineno if frames else None
    )
    text = error.msg if isinstance(error, SyntaxError) else ' '.join(f'{error}'.split())
    where = '' if line is None else f' in line {line}'
    return f'{type(error).__name__}{where}' + (f' ({text})' if text else '')
