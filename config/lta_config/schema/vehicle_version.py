"""
Upgrade vehicle files of older versions to the current one.

Version 1 had a single list of parts, only balloons, and a column of B for every rotor instead of
an axis. Its parts become one layer, `parts`, and each rotor points along the largest entry of its
column. Version 2 had a flat energy block (`vehicle_version_energy`).
"""

from typing import Any

from lta_config.schema.vehicle_version_energy import nest_energy

AXES = 'xyz'


def upgrade_content(content: Any) -> Any:  # noqa: ANN401 - whatever the file held
    """Return content of version 1 or 2 as version 3, and anything else unchanged."""
    if not isinstance(content, dict):
        return content
    # Versions are upgraded one after the other
    if content.get('schema') == 1:
        content = _convert_version_1(content)
    if content.get('schema') == 2:
        content = {**content, 'schema': 3, 'energy': nest_energy(content.get('energy'))}
    return content


def _convert_version_1(content: dict[str, Any]) -> dict[str, Any]:
    """Return content of version 1 as version 2."""
    content = {**content, 'schema': 2}
    if 'parts' in content:
        content['layers'] = {'parts': content.pop('parts')}
    if isinstance(content.get('hull'), dict):
        # A shape in the file wins, so that validation can report it
        content['hull'] = {'shape': 'balloon', **content['hull']}
    rotors = content.get('rotors')
    if isinstance(rotors, dict):
        content['rotors'] = {
            name: _add_axis(name, rotor, _find_columns(content)) for name, rotor in rotors.items()
        }
    return content


def _find_columns(content: dict[str, Any]) -> dict[str, Any] | None:
    """Return the columns of B by rotor; None if the file has none."""
    place: Any = content
    for key in ('aero', 'thrust_allocation'):
        place = place.get(key) if isinstance(place, dict) else None
    return place if isinstance(place, dict) else None


def _add_axis(name: str, rotor: Any, columns: dict[str, Any] | None) -> Any:  # noqa: ANN401
    """Return a rotor with an axis along the largest force in its column."""
    if columns is not None and name not in columns:
        raise ValueError(f'has no entry for the rotor {name} in aero.thrust_allocation; add one')
    force: Any = (columns or {}).get(name)
    for key in ('force', 'value'):
        force = force.get(key) if isinstance(force, dict) else None
    numbers = isinstance(force, list) and all(isinstance(x, int | float) for x in force)
    if not numbers or len(force) != len(AXES):
        force = [0.0, 0.0, 1.0]  # a placeholder: validation reports the invalid column
    if not isinstance(rotor, dict):
        return rotor
    most = max(range(3), key=lambda i: abs(force[i]))
    unit = [0.0, 0.0, 0.0]
    unit[most] = 1.0 if force[most] >= 0.0 else -1.0
    source = 'largest entry of its column of thrust_allocation in version 1 of the file'
    return {**rotor, 'axis': {'value': unit, 'unit': '1', 'source': source}}
