# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The mount file: position and orientation of a vehicle's solar panels, and their carrier.

A mount replaces one layer of a vehicle file. Mass, balance, inertia, drag and shade follow from
its parts as from any others.
"""

from collections.abc import Mapping
import math
from typing import Annotated, Any

from lta_config.errors import unknown_name_error
from lta_config.files import (
    find_file,
    load_yaml,
    Name,
    SchemaVersion,
    StrictModel,
    validate_content,
)
from lta_config.quantity import Quantity, si_quantity
from lta_config.schema.vehicle_body import Layer, PartBlock
from pydantic import Field, model_validator


class PanelFacing(StrictModel):
    """The direction that the lit face of a panel faces."""

    normal: Annotated[Quantity, si_quantity('1', low=-1.0, high=1.0, length=3, sourced=True)]

    @model_validator(mode='after')
    def _check_normal(self) -> 'PanelFacing':
        length = math.hypot(*self.normal.vector)
        # Tolerates components rounded to two digits
        if not 0.99 <= length <= 1.01:
            raise ValueError(
                f'has a normal of length {length:.3g}, but needs a unit vector; divide it by its '
                'length'
            )
        return self


class MountFile(StrictModel):
    """A mount file: the layer that it replaces, its parts, and which of them are panels."""

    schema_version: SchemaVersion
    name: Name
    about: str
    layer: Name
    parts: Layer
    panels: Annotated[Mapping[str, PanelFacing], Field(min_length=1)]

    @model_validator(mode='after')
    def _check_panels(self) -> 'MountFile':
        for name in self.panels:
            if name not in self.parts:
                raise ValueError(
                    f'has the panel {name}, but no part of that name; parts: '
                    f'{", ".join(self.parts)}'
                )
            if self.parts[name].shape != 'box':
                raise ValueError(
                    f'has the panel {name} with the shape {self.parts[name].shape}, but a panel '
                    'must have "shape: box"'
                )
        return self


def load_mount(name: str) -> MountFile:
    """Return a mount file by shipped name or path; raise `BadInput` if it is invalid."""
    path = find_file('mount', name)
    return validate_content(MountFile, load_yaml(path), str(path))


def mount_panels(
    content: Mapping[str, Any], name: str, ahead: float = 0.0, where: str = 'the vehicle'
) -> dict[str, Any]:
    """
    Return the content of a vehicle file with its panels mounted differently.

    Parameters
    ----------
    content : mapping
        The vehicle file as YAML holds it; not modified.
    name : str
        Mount: shipped name or path.
    ahead : float
        Forward mounting error of the panels. [m]
    where : str
        Name of the vehicle file in error messages.

    Raises
    ------
    BadInput
        If the mount cannot be read, or the vehicle has no such layer.

    """
    mount = load_mount(name)
    layers = content.get('layers')
    if not isinstance(layers, Mapping) or mount.layer not in layers:
        names = [str(key) for key in layers] if isinstance(layers, Mapping) else []
        raise unknown_name_error(f'layer of {where}', mount.layer, names)
    # The raw content, because the result is validated again as a vehicle file
    parts = dict(load_yaml(find_file('mount', name))['parts'])
    if ahead != 0.0:
        parts |= {
            panel: _move_part(parts[panel], mount.parts[panel], ahead) for panel in mount.panels
        }
    return {
        **content,
        'name': f'{content.get("name", "vehicle")}_{mount.name}',
        'layers': {**layers, mount.layer: parts},
        'energy': _replace_array(content.get('energy'), mount),
    }


def _replace_array(energy: Any, mount: MountFile) -> Any:
    """Return the energy block with its array on the first panel; it supports a single plane."""
    if not isinstance(energy, Mapping) or not isinstance(energy.get('array'), Mapping):
        return energy
    part, facing = next(iter(mount.panels.items()))
    normal = {'value': list(facing.normal.vector), 'unit': '1', 'source': f'mount {mount.name}'}
    return {**energy, 'array': {**energy['array'], 'part': part, 'normal': normal}}


def _move_part(held: Mapping[str, Any], part: PartBlock, ahead: float) -> dict[str, Any]:
    """Return a part as YAML holds it, shifted forward [m]."""
    x, y, z = part.position.vector
    place = {'value': [x + ahead, y, z], 'unit': 'm', 'source': 'deliberate mounting error'}
    return {**held, 'position': place}
