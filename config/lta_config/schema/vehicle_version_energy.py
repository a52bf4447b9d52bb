"""
Convert the flat energy block of vehicle files of version 2.

That block had a battery without relaxation, age or cut-offs, and a panel with constant efficiency
and lossless charging. The panel becomes as many generic cells of 1 cm2 as give the same power at
standard conditions. Everything else gets neutral values.
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
