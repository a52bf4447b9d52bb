# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Generate the page of all node parameters and launch arguments from their models."""

import ast
from collections.abc import Iterator
from importlib import import_module, resources
import inspect
import pkgutil
from types import ModuleType
from typing import Any

from lta_config.settings import format_bounds
from lta_graph.launches import FLY
from lta_graph.ros.node import GraphSettings
from lta_graph.ros.parameters import iterate_fields
from pydantic import BaseModel
from pydantic.fields import FieldInfo

PACKAGES = ('lta_sim', 'lta_vlc', 'lta_control', 'lta_energy', 'lta_bridge')
HEAD = """# Parameters

Generated from the settings of the nodes by `make reference`.

These are ROS parameters: `./lta run PACKAGE NODE --ros-args -p name:=value`, a launch file, or
`ros2 param set` with an installed ROS 2. A value of a wrong type or outside the bounds is
rejected with an error message. *Fixed* parameters can only be set at start. `lta simulate --set`
accepts those of estimator, demodulator, navigator (`mission`) and energy monitor. Gains of a
vehicle are files in `config/control`. The [launch arguments](#lta-launch-fly) set many of them:
`./lta launch fly seed:=2`.
"""
LAUNCH = """
## lta launch fly
`./lta launch fly --show-args` says what each argument means, and `./lta launch fleet --show-args`
and `./lta launch emulated --show-args` list theirs. With the defaults:

"""


def render_page() -> str:
    """Return the page: the common parameters, a section for each node, and the launch."""
    tables = [
        format_model_section(
            'Every node', GraphSettings, 'Parameters that all ROS nodes of LTA have.'
        )
    ]
    tables += [
        format_model_section(f'{package} {node}', model)
        for package, node, model in iterate_settings_models()
    ]
    return HEAD + ''.join(tables) + LAUNCH + format_arguments(FLY.arguments)


def iterate_settings_models() -> Iterator[tuple[str, str, type[BaseModel]]]:
    """Yield package, node name and settings model of each node."""
    for package in PACKAGES:
        # Every module in `nodes` is one node
        folder = resources.files(f'{package}.nodes')
        for item in pkgutil.iter_modules([str(folder)]):
            module = import_module(f'{package}.nodes.{item.name}')
            for model in find_settings_models(module):
                yield package, item.name, model


def find_settings_models(module: ModuleType) -> Iterator[type[BaseModel]]:
    """Yield the models in calls of `NodeParameters(node, MODEL, ...)`, without creating a node."""
    for call in ast.walk(ast.parse(inspect.getsource(module))):
        if (
            isinstance(call, ast.Call)
            and getattr(call.func, 'id', '') == 'NodeParameters'
            and isinstance(model := call.args[1], ast.Name)
        ):
            yield getattr(module, model.id)


def format_model_section(title: str, model: type[BaseModel], about: str = '') -> str:
    """Return a heading and the list of a model's parameters."""
    rows = ''.join(format_parameter_row(*leaf) for leaf in iterate_fields(model()))
    text = f'\n## {title}\n' + (f'{about}\n\n' if about else '\n')
    return text + rows


def format_parameter_row(name: str, info: FieldInfo, value: Any) -> str:
    """Return one parameter as an item of the list: name, default, bounds and meaning."""
    extra = info.json_schema_extra if isinstance(info.json_schema_extra, dict) else {}
    fixed = ' *Fixed.*' if extra.get('read_only') else ''
    about = info.description or ''
    unit = str(extra.get('unit') or '')
    unit = '' if unit == '1' else unit  # a pure number
    default = format_default(value)
    number = ', '.join(
        filter(None, (f'`{default}` {unit}'.strip() if default else unit, format_bounds(info)))
    )
    return f'- `{name}`{f" ({number})" if number else ""}: {about}{fixed}\n'


def format_arguments(model: type[BaseModel]) -> str:
    """Return the names of launch arguments with their defaults, as on the command line."""
    leaves = iterate_fields(model())
    words = [f'`{name}:={format_default(value)}`' for name, _, value in leaves]
    return ', '.join(words) + '.\n'


def format_default(value: object) -> str:
    """Format a default as on the command line; empty if there is none."""
    if value in ('', None, ()):
        return ''
    if isinstance(value, tuple):
        return f'[{", ".join(str(item) for item in value)}]'
    return str(value).lower() if isinstance(value, bool) else str(value)
