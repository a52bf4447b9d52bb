"""
The mount file: where the solar panels of a vehicle sit, which way they face, and on what.

A mount takes the place of one layer of a vehicle file. Mass, balance, inertia, drag and shade then
follow from its parts as they do from any other.
"""

from collections.abc import Mapping
import math
from typing import Annotated, Any, Literal

from lta_config.errors import unknown_name
from lta_config.files import find_file, load_yaml, StrictModel, validate_content
from lta_config.quantity import Quantity, si_quantity
from lta_config.schema.vehicle_body import Layer, PartBlock
from pydantic import AliasChoices, Field, model_validator

Name = Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]


class PanelFacing(StrictModel):
    """Which way the lit face of a panel looks."""

    normal: Annotated[Quantity, si_quantity('1', low=-1.0, high=1.0, length=3, sourced=True)]

    @model_validator(mode='after')
    def _check_normal(self) -> 'PanelFacing':
        length = math.hypot(*self.normal.vector)
        if not 0.99 <= length <= 1.01:
            raise ValueError(f'has a normal of length {length:.3g}; divide it by that')
        return self


class MountFile(StrictModel):
    """A whole mount file: the layer whose place it takes, its parts, and which of them are lit."""

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
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
                    f'has no part {name}, which is one of its panels; parts: '
                    f'{", ".join(self.parts)}'
                )
            if self.parts[name].shape != 'box':
                raise ValueError(f'has the panel {name}, which is no box; make it one')
        return self


def load_mount(name: str) -> MountFile:
    """Return a mount file by shipped name or path; anything wrong is a `BadInput` sentence."""
    path = find_file('mount', name)
    return validate_content(MountFile, load_yaml(path), str(path))


def mount_panels(
    content: Mapping[str, Any], name: str, ahead: float = 0.0, where: str = 'the vehicle'
) -> dict[str, Any]:
    """
    Return what a vehicle file holds with its panels mounted otherwise.

    Parameters
    ----------
    content : mapping
        The vehicle file as YAML holds it; not changed.
    name : str
        Mount: shipped name or path.
    ahead : float
        How far ahead of their places the panels sit, by mistake. [m]
    where : str
        What to call the vehicle file in a complaint.

    Raises
    ------
    BadInput
        If the mount cannot be read, or the vehicle lacks the layer whose place it takes.

    """
    mount = load_mount(name)
    layers = content.get('layers')
    if not isinstance(layers, Mapping) or mount.layer not in layers:
        known = [str(key) for key in layers] if isinstance(layers, Mapping) else []
        raise unknown_name(f'layer of {where}', mount.layer, known)
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


def _replace_array(energy: Any, mount: MountFile) -> Any:  # noqa: ANN401 - what YAML holds
    """Return the energy block with its array on the first panel; it knows one plane alone."""
    if not isinstance(energy, Mapping) or not isinstance(energy.get('array'), Mapping):
        return energy
    part, facing = next(iter(mount.panels.items()))
    normal = {'value': list(facing.normal.vector), 'unit': '1', 'source': f'mount {mount.name}'}
    return {**energy, 'array': {**energy['array'], 'part': part, 'normal': normal}}


def _move_part(held: Mapping[str, Any], part: PartBlock, ahead: float) -> dict[str, Any]:
    """Return a part as YAML holds it, sitting further ahead. [m]"""
    x, y, z = part.position.vector
    place = {'value': [x + ahead, y, z], 'unit': 'm', 'source': 'out of place on purpose'}
    return {**held, 'position': place}
