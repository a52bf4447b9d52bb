"""
The mount file: where the solar panels of a vehicle sit, which way they face, and on what.

A mount takes the place of one layer of a vehicle file. Mass, balance, inertia, drag and shade then
follow from its parts as they do from any other.
"""

from collections.abc import Mapping
import math
from typing import Annotated, Any, Literal

from lta_config.errors import unknown
from lta_config.files import checked, find, load_yaml, Record
from lta_config.quantity import Quantity, si
from lta_config.schema.vehicle_body import Layer, Part
from pydantic import AliasChoices, Field, model_validator

Name = Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]


class Facing(Record):
    """Which way the lit face of a panel looks."""

    normal: Annotated[Quantity, si('1', low=-1.0, high=1.0, length=3, sourced=True)]

    @model_validator(mode='after')
    def _points_somewhere(self) -> 'Facing':
        length = math.hypot(*self.normal.vector)
        if not 0.99 <= length <= 1.01:
            raise ValueError(f'has a normal of length {length:.3g}; divide it by that')
        return self


class Mount(Record):
    """A whole mount file: the layer whose place it takes, its parts, and which of them are lit."""

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    name: Name
    about: str
    layer: Name
    parts: Layer
    panels: Annotated[Mapping[str, Facing], Field(min_length=1)]

    @model_validator(mode='after')
    def _panels_are_boxes(self) -> 'Mount':
        for name in self.panels:
            if name not in self.parts:
                raise ValueError(
                    f'has no part {name}, which is one of its panels; parts: '
                    f'{", ".join(self.parts)}'
                )
            if self.parts[name].shape != 'box':
                raise ValueError(f'has the panel {name}, which is no box; make it one')
        return self


def load_mount(name: str) -> Mount:
    """Return a mount file by shipped name or path; anything wrong is a `BadInput` sentence."""
    path = find('mount', name)
    return checked(Mount, load_yaml(path), str(path))


def mounted(
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
        raise unknown(f'layer of {where}', mount.layer, known)
    parts = dict(load_yaml(find('mount', name))['parts'])
    if ahead != 0.0:
        parts |= {panel: _moved(parts[panel], mount.parts[panel], ahead) for panel in mount.panels}
    return {
        **content,
        'name': f'{content.get("name", "vehicle")}_{mount.name}',
        'layers': {**layers, mount.layer: parts},
        'energy': _harvesting(content.get('energy'), mount),
    }


def _harvesting(energy: Any, mount: Mount) -> Any:  # noqa: ANN401 - what YAML holds
    """Return the energy block with its array on the first panel; it knows one plane alone."""
    if not isinstance(energy, Mapping) or not isinstance(energy.get('array'), Mapping):
        return energy
    part, facing = next(iter(mount.panels.items()))
    normal = {'value': list(facing.normal.vector), 'unit': '1', 'source': f'mount {mount.name}'}
    return {**energy, 'array': {**energy['array'], 'part': part, 'normal': normal}}


def _moved(held: Mapping[str, Any], part: Part, ahead: float) -> dict[str, Any]:
    """Return a part as YAML holds it, sitting further ahead. [m]"""
    x, y, z = part.position.vector
    place = {'value': [x + ahead, y, z], 'unit': 'm', 'source': 'out of place on purpose'}
    return {**held, 'position': place}
