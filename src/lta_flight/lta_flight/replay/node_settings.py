# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Parse and check node parameters from a command line, before a node starts."""

from collections.abc import Sequence
from importlib import import_module
from typing import Any

from lta_config.errors import BadInput, unknown_name_error
from lta_config.files import format_error, parse_yaml
from lta_config.settings import Settings
from lta_graph.ros.parameters import iterate_fields, nest_names
from pydantic import ValidationError

NODES = {  # module and model of each node's parameters, imported late because of rclpy
    'estimator': ('lta_control.parameters', 'EstimatorParameters'),
    'controller': ('lta_control.parameters', 'ControllerSettings'),
    'demodulator': ('lta_vlc.nodes.demodulator', 'DemodulatorParameters'),
    'navigator': ('lta_control.parameters', 'NavigatorParameters'),
    'energy_monitor': ('lta_energy.nodes.energy_monitor', 'EnergyMonitorParameters'),
}


def load_settings_model(node: str) -> type[Settings]:
    """Return the parameter model of a node."""
    module, name = NODES[node]
    model: type[Settings] = getattr(import_module(module), name)
    return model


def parse_settings(assignments: Sequence[str], nodes: Sequence[str]) -> dict[str, dict[str, Any]]:
    """
    Return changed parameters by node.

    `assignments`: each NODE.PARAMETER=VALUE. `nodes`: the nodes that are run again. Raise
    `BadInput` if a node is not run again, the parameter does not exist, or the value is invalid.
    """
    settings: dict[str, dict[str, Any]] = {}
    for text in assignments:
        path, equals, value = text.partition('=')
        node, dot, name = path.strip().partition('.')
        if not (equals and dot and name):
            raise BadInput(f"--set '{text}' is not an assignment; write NODE.PARAMETER=VALUE.")
        if node not in nodes:
            raise unknown_name_error('replayed node', node, list(nodes))
        settings.setdefault(node, {})[name] = parse_typed_value(node, name, value)
    for node, values in settings.items():
        try:
            # Not strict, as in `NodeParameters`
            load_settings_model(node).model_validate(nest_names(values), strict=False)
        except ValidationError as error:
            raise BadInput(f'{node}: parameter {format_error(error)}') from None
    return settings


def parse_typed_value(node: str, name: str, text: str) -> Any:
    """Return a parameter's value from text, with the type that the node declares."""
    values = {key: value for key, _, value in iterate_fields(load_settings_model(node)())}
    if name not in values:
        raise unknown_name_error(f'parameter of {node}', name, list(values))
    if isinstance(values[name], str):
        return text
    value = parse_yaml(text, f'{node}.{name}')
    # ROS would reject the integer 1 for a parameter of type double
    return float(value) if isinstance(values[name], float) and type(value) is int else value
