# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Declare ROS parameters from a pydantic model.

The frozen model defines type, default, bounds, unit and description; the parameter descriptors
follow from it. A change at run time is accepted only if the whole model still validates.
Otherwise the model's error message is the reason given.
"""

from collections.abc import Callable, Iterator, Mapping
from typing import Any, Generic, TypeVar

from lta_config.errors import BadInput
from lta_config.files import format_error
from lta_config.settings import setting, Settings
from lta_config.topics import is_name
from pydantic import BaseModel, create_model, ValidationError
from pydantic.fields import FieldInfo
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rclpy.node import Node
from rclpy.parameter import Parameter

Model = TypeVar('Model', bound=BaseModel)


def iterate_fields(settings: BaseModel, prefix: str = '') -> Iterator[tuple[str, FieldInfo, Any]]:
    """Yield the dotted name, the field and the value of every parameter of a model."""
    for name, info in type(settings).model_fields.items():
        value = getattr(settings, name)
        if isinstance(value, BaseModel):
            yield from iterate_fields(value, f'{prefix}{name}.')
        else:
            yield prefix + name, info, value


def build_descriptor(info: FieldInfo, default: Any) -> ParameterDescriptor:
    """Return the descriptor of one field: description with unit, range and read-only flag."""
    extra = info.json_schema_extra if isinstance(info.json_schema_extra, dict) else {}
    unit = extra.get('unit')
    # pydantic keeps `ge=` and `le=` as annotated_types.Ge and .Le in the metadata
    bounds = {type(item).__name__: item for item in info.metadata}
    low = getattr(bounds.get('Ge'), 'ge', None)
    high = getattr(bounds.get('Le'), 'le', None)
    descriptor = ParameterDescriptor(
        description=f'{info.description or ""}{f" [{unit}]" if unit else ""}',
        read_only=bool(extra.get('read_only', False)),
        # rclpy cannot infer the element type of an empty list
        dynamic_typing=isinstance(default, tuple),
    )
    if low is not None and high is not None:
        # bool is a subclass of int, but has no range
        if isinstance(default, int) and not isinstance(default, bool):
            descriptor.integer_range = [IntegerRange(from_value=low, to_value=high, step=0)]
        else:
            ends = {'from_value': float(low), 'to_value': float(high), 'step': 0.0}
            descriptor.floating_point_range = [FloatingPointRange(**ends)]
    return descriptor


def nest_names(flat: Mapping[str, Any]) -> dict[str, Any]:
    """Return dotted names as nested mappings."""
    tree: dict[str, Any] = {}
    for name, value in flat.items():
        *path, last = name.split('.')
        branch = tree
        for part in path:
            branch = branch.setdefault(part, {})
        # Strict models take lists from YAML, and ROS has no tuples either
        branch[last] = list(value) if isinstance(value, tuple) else value
    return tree


class NodeParameters(Generic[Model]):
    """
    The parameters of one node as a validated, frozen model.

    `model`: pydantic model with a default for every field; nested models become dotted names.
    `changed`: called with the new model after an accepted change. `check`: called with each valid
    model before it is accepted, also at start-up. It raises ValueError (`BadInput`) if the node
    cannot work with the values. Raise `BadInput` if a value given at start-up is not valid.
    """

    def __init__(
        self,
        node: Node,
        model: type[Model],
        changed: Callable[[Model], None] | None = None,
        check: Callable[[Model], object] | None = None,
    ) -> None:
        self._model = model
        self._usable = check
        self._changed = changed
        self._node = node
        self._names = []
        for name, info, default in iterate_fields(model()):
            descriptor = build_descriptor(info, default)
            try:
                node.declare_parameter(name, default, descriptor)
            # rclpy raises several classes, among them for a value of the wrong type
            except Exception as error:
                raise BadInput(f'{node.get_name()}: parameter {name}: {error}.') from None
            self._names.append(name)
        try:
            self.value = self._build_model({})
        except ValidationError as error:
            raise BadInput(f'{node.get_name()}: parameter {format_error(error)}') from None
        except ValueError as error:
            raise BadInput(f'{node.get_name()}: {error}') from None
        # rclpy first asks whether a change is valid, and calls the second hook once it is set
        node.add_on_set_parameters_callback(self._validate_changes)
        node.add_post_set_parameters_callback(self._apply_changes)

    def _build_model(self, changes: Mapping[str, Any]) -> Model:
        current = {name: self._node.get_parameter(name).value for name in self._names}
        # Not strict, because a ROS array must be accepted for a tuple
        built = self._model.model_validate(nest_names({**current, **changes}), strict=False)
        if self._usable is not None:
            self._usable(built)
        return built

    def _own_parameter_values(self, parameters: list[Parameter]) -> dict[str, Any]:
        return {item.name: item.value for item in parameters if item.name in self._names}

    def _validate_changes(self, parameters: list[Parameter]) -> SetParametersResult:
        try:
            self._build_model(self._own_parameter_values(parameters))
        except ValidationError as error:
            return SetParametersResult(successful=False, reason=format_error(error))
        except ValueError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _apply_changes(self, parameters: list[Parameter]) -> None:
        # The node may have further parameters, such as qos_overrides
        if not self._own_parameter_values(parameters):
            return
        self.value = self._build_model({})
        if self._changed is not None:
            self._changed(self.value)


def declare_robots(node: Node, names: str, model: type[Model]) -> dict[str, Model]:
    """
    Declare and return the settings of each robot, in parameters such as `lta2.seed`.

    `names`: namespaces, separated by spaces. `model`: the settings of one robot. Raise `BadInput`
    if a name is not valid or is given twice.
    """
    robots = names.split()
    for name in robots:
        if not is_name(name) or robots.count(name) > 1:
            raise BadInput(
                f"The parameter robots of {node.get_name()} is '{names}', but '{name}' is not a "
                'valid namespace or is given twice; give different namespaces.'
            )
    fields: Any = {name: (model, setting(model())) for name in robots}
    values = NodeParameters(node, create_model('Robots', __base__=Settings, **fields)).value
    return {name: getattr(values, name) for name in robots}
