# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What is hidden in flights of a GT-MAB: changes of its file, by the name that is to be found."""

import numpy as np

Changes = dict[str, object]


def _is(value: float | list[float], unit: str = '1') -> dict[str, object]:
    """Return a quantity as a file has it."""
    return {'value': value, 'unit': unit}


_ON = 'vehicle.effects.'
_DRAG = 'vehicle.aero.linear_drag.force'
CASES: dict[str, Changes] = {
    'rotor_fault.lost_3': {f'{_ON}rotor_fault.lost_3': _is(0.14)},
    'rotor_fault.lost_1': {f'{_ON}rotor_fault.lost_1': _is(0.14)},
    'linear_drag.surge': {_DRAG: _is([0.03, 0.0, 0.0], 'N s/m')},
    'linear_drag.heave': {_DRAG: _is([0.0, 0.0, 0.03], 'N s/m')},
    'quadratic_drag.surge': {
        'vehicle.aero.quadratic_drag.force': _is([0.15, 0.092, 0.359], 'N s2/m2')
    },
    'rotational_drag.yaw': {
        'vehicle.aero.linear_drag.moment': _is([7e-4, 6.2e-4, 1.2e-3], 'N m s')
    },
    'motor_lag': {f'{_ON}motor_lag.up': _is(0.12, 's'), f'{_ON}motor_lag.down': _is(0.12, 's')},
    'motor_deadband.threshold': {f'{_ON}motor_deadband.threshold': _is(0.08)},
    'command_delay.delay': {f'{_ON}command_delay.delay': _is(0.045, 's')},
    'cg_offset.x': {f'{_ON}cg_offset.x': _is(0.006, 'm')},
    'cg_offset.y': {f'{_ON}cg_offset.y': _is(0.004, 'm')},
    'net_lift.force': {f'{_ON}net_lift.force': _is(-0.008, 'N')},
    'steady_wind.y': {f'{_ON}steady_wind.y': _is(0.08, 'm/s')},
    'thrust_scale.factor': {f'{_ON}thrust_scale.factor': _is(0.8)},
    'helium_leak.rate': {f'{_ON}helium_leak.rate': _is(1e-4, 'N/s')},
    'range_offset.offset': {f'{_ON}range_offset.offset': _is(0.1, 'm')},
    'tracker_delay.delay': {f'{_ON}tracker_delay.delay': _is(0.03, 's')},
    'rotor_misalignment.second_3': {f'{_ON}rotor_misalignment.second_3': _is(0.07, 'rad')},
    'battery_sag.sensitivity': {
        f'{_ON}battery_sag.voltage': _is(3.7, 'V'),
        f'{_ON}battery_sag.sensitivity': _is(0.8),
    },
    'tracker_misalignment.pitch': {f'{_ON}tracker_misalignment.pitch': _is(0.02, 'rad')},
}


def off_by_tolerance(seed: int) -> Changes:
    """Return a vehicle that is off by what vehicles are off by; no effect is in it."""
    rng = np.random.default_rng([seed, 11])

    def part(share: float) -> float:
        return 1.0 + share * float(rng.standard_normal())

    def about(deviation: float, unit: str) -> dict[str, object]:
        return _is(deviation * float(rng.standard_normal()), unit)

    lag = _is(0.072 * part(0.083), 's')
    toes = {
        f'{_ON}rotor_misalignment.{way}_{i}': about(0.0087, 'rad')
        for way in ('first', 'second')
        for i in range(1, 5)
    }
    drag = 'vehicle.aero.quadratic_drag'
    return {
        f'{_ON}thrust_scale.factor': _is(part(0.03)),
        f'{drag}.force': _is([d * part(0.05) for d in (0.092, 0.092, 0.359)], 'N s2/m2'),
        f'{drag}.moment': _is([d * part(0.05) for d in (2.14e-3, 2.14e-3, 6.4e-4)], 'N m s2'),
        f'{_ON}cg_offset.x': about(5e-4, 'm'),
        f'{_ON}cg_offset.y': about(5e-4, 'm'),
        f'{_ON}cg_height.z': about(3e-3, 'm'),
        f'{_ON}net_lift.force': about(6e-4, 'N'),
        f'{_ON}motor_lag.up': lag,
        f'{_ON}motor_lag.down': lag,
        **toes,
    }
