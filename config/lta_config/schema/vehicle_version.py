"""
Upgrade vehicle files of older versions to the current one.

Version 1 had a single list of parts, only balloons, and a column of B for every rotor instead of
an axis. Its parts become one layer, `parts`, and each rotor points along the largest entry of its
column. Version 2 had a flat energy block.
"""

from typing import Any

from lta_config.quantity import UNITS

GENERIC = 'monocrystalline'  # in config/cells: 20 % of 1 cm2
GENERIC_POWER = 0.020  # W at standard conditions
STANDARD = 1000.0  # W/m2, irradiance of standard conditions
SECONDS_PER_HOUR = 3600.0
SOURCE = 'assumed: not given in version 2 of the file'


def nest_energy(energy: Any) -> Any:  # noqa: ANN401 - whatever the file held
    """Return a flat energy block as nested battery, array, charger and loads."""
    if not isinstance(energy, dict) or 'battery' in energy or 'loads' in energy:
        return energy
    rest = dict(energy)
    battery = {key: rest.pop(key) for key in ('capacity', 'resistance') if key in rest}
    loads = {
        key: rest.pop(key)
        for key in ('idle', 'transmitting', 'rotor_idle', 'rotor_power')
        if key in rest
    }
    panel = [_to_si(rest.pop(f'panel_{key}', None)) for key in ('area', 'efficiency', 'voltage')]
    return {
        **rest,
        'battery': {**battery, **_ideal_battery_values(battery)},
        'loads': loads,
        **_build_array_and_charger(*panel),
    }


def _ideal_battery_values(battery: dict[str, Any]) -> dict[str, Any]:
    """Return the further values of an ideal battery: new, without relaxation, usual cut-offs."""
    capacity = _to_si(battery.get('capacity')) or 1.0
    return {
        'relaxation_resistance': _assume_quantity(0.0, 'ohm'),
        'relaxation_time': _assume_quantity(1.0, 's'),
        'temperature': _assume_quantity(25.0, 'degC'),
        'age': _assume_quantity(0.0, '1'),
        'discharge_cutoff': _assume_quantity(3.0, 'V'),
        'charge_cutoff': _assume_quantity(4.2, 'V'),
        # A charge rate of 1C
        'charge_current': _assume_quantity(capacity / SECONDS_PER_HOUR, 'A'),
    }


def _build_array_and_charger(
    area: float | None, efficiency: float | None, _: float | None
) -> dict[str, Any]:
    """Return array and charger with the power of a panel; empty if there was none."""
    count = round((area or 0.0) * (efficiency or 0.0) * STANDARD / GENERIC_POWER)
    if count == 0:
        return {}
    lossless = _assume_quantity(1.0, '1')
    return {
        'array': {
            'cell': GENERIC, 'series': 1, 'parallel': count,
            'normal': _assume_quantity([0.0, 0.0, 1.0], '1'),
        },
        'charger': {
            'tracking': lossless, 'conversion': lossless, 'idle': _assume_quantity(0.0, 'W'),
        },
    }  # fmt: skip


def _assume_quantity(value: float | list[float], unit: str) -> dict[str, Any]:
    return {'value': value, 'unit': unit, 'source': SOURCE}


def _to_si(quantity: Any) -> float | None:  # noqa: ANN401 - whatever the file held
    """Return a quantity in SI; None if it is invalid, which validation reports."""
    if not isinstance(quantity, dict):
        return None
    value, unit = quantity.get('value'), quantity.get('unit')
    if isinstance(value, bool) or not isinstance(value, int | float) or unit not in UNITS:
        return None
    return value * UNITS[unit][1]


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
