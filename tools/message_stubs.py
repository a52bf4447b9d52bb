# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Write the types of the ROS messages for mypy, from the installed classes: build/typings.

The generated classes have no annotations. A stub has the fields of each message, service and
action in the types that their properties return; for an array, a setter takes any sequence.
"""

from importlib import import_module
from pathlib import Path
import re
import sys

FOLDER = Path(__file__).resolve().parents[1] / 'build' / 'typings'
PACKAGES = (
    'action_msgs', 'builtin_interfaces', 'diagnostic_msgs', 'geometry_msgs', 'lta_msgs',
    'nav_msgs', 'rcl_interfaces', 'rosgraph_msgs', 'sensor_msgs', 'std_msgs', 'std_srvs',
    'tf2_msgs', 'unique_identifier_msgs', 'visualization_msgs',
)  # fmt: skip
PARTS = 'Request', 'Response', 'Goal', 'Result', 'Feedback'
NUMBERS = {'boolean': 'bool', 'float': 'float', 'double': 'float', 'octet': 'bytes'}
HEAD = """from array import array
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

"""


def find_types(field: str) -> tuple[str, str]:
    """Return the type that a field returns, and the type that it takes."""
    match = re.fullmatch(r'sequence<(.+?)(?:, \d+)?>|(.+)\[\d+\]', field)
    if match is None:
        kind = find_scalar(field)
        return kind, kind
    kind = find_scalar(match[1] or match[2])
    if kind not in ('int', 'float'):
        return f'list[{kind}]', f'Sequence[{kind}]'
    taken = f'Sequence[{kind}] | array[{kind}] | NDArray[np.generic]'
    return (f'array[{kind}]' if match[1] else 'NDArray[np.float64]'), taken


def find_scalar(field: str) -> str:
    """Return the type of one value."""
    if field in NUMBERS:
        return NUMBERS[field]
    if re.fullmatch(r'u?int\d+', field):
        return 'int'
    if field.startswith(('string', 'wstring')):
        return 'str'
    package, name = field.split('/')
    return f'{package}.msg.{name}'


def render_class(name: str, kind: type, indent: str = '') -> str:
    """Return the stub of one class, with the classes inside it."""
    lines = [f'{indent}class {name}:']
    parts = [part for part in PARTS if isinstance(getattr(kind, part, None), type)]
    if parts:
        # A service or an action
        lines += [render_class(part, getattr(kind, part), f'{indent}    ') for part in parts]
        return '\n'.join(lines)
    lines += [
        f'{indent}    {constant}: {type(getattr(kind, constant)).__name__}'
        for constant in dir(type(kind))
        if constant.isupper() and isinstance(getattr(kind, constant), int | float | str | bytes)
    ]
    fields = kind.get_fields_and_field_types()  # type: ignore[attr-defined]
    words = [f'{field}: {find_types(text)[1]} = ...' for field, text in fields.items()]
    star = ', *, ' if words else ''
    lines.append(f'{indent}    def __init__(self{star}{", ".join(words)}) -> None: ...')
    for field, text in fields.items():
        gets, takes = find_types(text)
        lines += [
            f'{indent}    @property',
            f'{indent}    def {field}(self) -> {gets}: ...',
            f'{indent}    @{field}.setter',
            f'{indent}    def {field}(self, value: {takes}) -> None: ...',
        ]
    return '\n'.join(lines)


def main() -> None:
    """Write the stubs of all packages."""
    for package in PACKAGES:
        for part in ('msg', 'srv', 'action'):
            try:
                module = import_module(f'{package}.{part}')
            except ModuleNotFoundError:
                continue
            classes = [
                render_class(name, kind)
                for name, kind in vars(module).items()
                if isinstance(kind, type) and '_' not in name
            ]
            text = '\n\n'.join(classes)
            used = sorted(set(re.findall(r'\b(\w+)\.msg\.', text)))
            imports = ''.join(f'import {name}.msg\n' for name in used)
            folder = FOLDER / package / part
            folder.mkdir(parents=True, exist_ok=True)
            (FOLDER / package / '__init__.pyi').touch()
            (folder / '__init__.pyi').write_text(f'{HEAD}{imports}\n{text}\n', encoding='utf-8')


if __name__ == '__main__':
    sys.exit(main())
