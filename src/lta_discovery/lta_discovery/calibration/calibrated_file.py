"""Write the calibrated vehicle file."""

from collections.abc import Iterator, Sequence
from typing import Final

from lta_config.errors import BadInput
from lta_config.files import parse_yaml
from lta_config.vehicle_edit import set_yaml_value
from lta_discovery.calibration.calibration import CalibratedValue, Calibration
from lta_discovery.page.formatting import format_with_interval
from lta_discovery.results.learned_file import list_changed_quantities, VehicleFileQuantity
from lta_model.vehicle import Vehicle
import numpy as np

NAME: Final = 'calibrated.yaml'
CURVES: Final = 'effects.thrust_curve'  # which belong to the rotors


def format_calibrated_vehicle(
    text: str, vehicle: Vehicle, calibration: Calibration, source: str
) -> str:
    """
    Return the text of the vehicle file with the calibrated values.

    Mass and inertia are written as those of the whole vehicle (`measured`), whose parts then keep
    their places without weight. The net lift is the mean of the flights.

    Raises
    ------
    BadInput
        If the format has no place for a number.

    """
    notes = {}
    for one in calibration.values:
        effect, _, parameter = one.name.partition('.')
        if not one.flight:
            notes[effect, parameter] = format_value(one)
    for quantity in list_changed_quantities(
        text, vehicle, calibration.nominal, calibration.calibrated, notes, source
    ):
        if not quantity.place.startswith(CURVES):
            text = set_yaml_value(text, quantity.place.split('.'), quantity.as_yaml)
    for quantity in _list_thrust_curves(vehicle, calibration, source):
        text = set_yaml_value(text, quantity.place.split('.'), quantity.as_yaml)
    if calibration.nominal.mass == calibration.calibrated.mass and np.array_equal(
        calibration.nominal.inertia, calibration.calibrated.inertia
    ):
        return text
    return _set_mass_properties(text, vehicle, calibration, source)


def _list_thrust_curves(
    vehicle: Vehicle, calibration: Calibration, source: str
) -> Iterator[VehicleFileQuantity]:
    """Yield the thrust curves of the rotors that changed."""
    for i, (name, rotor) in enumerate(vehicle.file.rotors.items(), start=1):
        now, before = (
            [one.parameter_value('thrust_curve', f'{letter}_{i}') for letter in 'ab']
            for one in (calibration.calibrated, calibration.nominal)
        )
        if now == before:
            continue
        if now[1] <= 0.0:
            raise BadInput(
                f'The rotor {name} pushes against its axis; turn its axis and its thrust '
                'allocation around in the vehicle file, and calibrate again.'
            )
        curve = rotor.thrust_curve or vehicle.file.thrust_curve
        values = dict(zip('ab', now, strict=True))
        if curve is not None and curve.reverse is not None:
            values['reverse'] = curve.reverse.si * now[1] / before[1]
        for key, value in values.items():
            yield VehicleFileQuantity(f'rotors.{name}.thrust_curve.{key}', value, 'N', source)


def _set_mass_properties(
    text: str, vehicle: Vehicle, calibration: Calibration, source: str
) -> str:
    """Return the text with the mass properties of the whole vehicle."""
    now, inertia = calibration.calibrated, calibration.calibrated.inertia
    if vehicle.file.moving_mass is not None:
        raise BadInput(
            f'{vehicle.file.name} has a moving mass, so its calibrated mass cannot be written; '
            'the other values are those of the report.'
        )
    products = [float(inertia[0, 1]), float(inertia[0, 2]), float(inertia[1, 2])]
    quantities = [
        VehicleFileQuantity('measured.mass', float(now.mass), 'kg', source),
        VehicleFileQuantity('measured.position', now.cg.tolist(), 'm', 'unchanged by the fit'),
        VehicleFileQuantity('measured.inertia', np.diag(inertia).tolist(), 'kg m2', source),
        VehicleFileQuantity('measured.products', products, 'kg m2', source),
    ]
    for one in quantities:
        text = set_yaml_value(text, one.place.split('.'), one.as_yaml)
    if now.displaced <= 0.0:
        return text
    # The mass contains the ballast, which has no place of its own then
    heavier = VehicleFileQuantity(
        'trim.heaviness',
        float(now.mass - now.displaced),
        'kg',
        'mass less displaced air, as before',
    )
    content = parse_yaml(text, vehicle.file.name)
    trim = {
        k: v
        for k, v in content.get('trim', {}).items()
        if k not in ('ballast_position', 'ballast')
    }
    return set_yaml_value(text, ['trim'], {**trim, 'heaviness': heavier.as_yaml})


def format_value(one: CalibratedValue) -> str:
    """Return a value with its interval in words."""
    value, low, high = format_with_interval(one.value, one.ci95)
    return f'{value} {one.unit}, 95 % {low} to {high}'


def format_calibration_source(bags: Sequence[str], commit: str) -> str:
    """Return the source of the calibrated numbers."""
    return f'lta calibrate from {", ".join(bags)}, commit {commit}'
