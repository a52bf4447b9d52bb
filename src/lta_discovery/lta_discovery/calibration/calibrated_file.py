# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Write the calibrated vehicle file."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
import math
from typing import Any, Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_config.files import parse_yaml
from lta_config.vehicle_edit import set_yaml_values
from lta_discovery.calibration.result import CalibratedValue, Calibration, WIDE
from lta_discovery.changed_quantities import list_changed_quantities, VehicleFileQuantity
from lta_discovery.formatting import format_with_interval
from lta_discovery.model.calibration_parameters import reversed_column
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_model.effects.protocol import AXES
from lta_model.mass_properties import MassElement, MassProperties
from lta_model.propulsion import geometric_column, RotorModel
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CALIBRATED_FILE: Final = 'calibrated.yaml'
CURVE: Final = 'thrust_curve'  # the effect whose numbers belong to the rotors
STRIP_EFFECT: Final = 'strip_damping'  # the effect whose numbers follow from the drag of the parts
# Beginnings of places whose numbers the file states in other blocks
DERIVED_PLACES: Final = (
    f'effects.{CURVE}.',
    f'effects.{STRIP_EFFECT}.',
    *(f'effects.rotor_envelope_interaction.{axis}_' for axis in AXES),
)


@final
class VehicleUpdate(NamedTuple):
    """A vehicle before and after some of its values were fitted."""

    before: NominalVehicle
    after: NominalVehicle


def format_calibrated_vehicle(
    text: str, vehicle: Vehicle, calibration: Calibration, source: str
) -> str:
    """
    Return the text of the vehicle file with the calibrated values.

    Mass and inertia are written as those of the whole vehicle (`measured`), whose parts then keep
    their places without weight. The net lift is the mean of the flights. A rotor's share of the
    thrust in the file, which may be negative, scales its column in the thrust allocation, and what
    it pushes in reverse is the reversed one.

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
    # Without the references of the gains, which the calibration chose
    before = NominalVehicle.from_vehicle(vehicle)
    change = VehicleUpdate(before, calibration.calibrated)
    return format_changed_vehicle(text, vehicle, change, notes, source)


def format_changed_vehicle(
    text: str,
    vehicle: Vehicle,
    change: VehicleUpdate,
    notes: Mapping[tuple[str, str], str],
    source: str,
) -> str:
    """
    Return the text of a vehicle file with all changed values, also mass, inertia and thrust.

    Parameters
    ----------
    notes : mapping of (str, str) to str
        Note for the source of a parameter of an effect.

    Raises
    ------
    BadInput
        If the format has no place for a number.

    """
    straight = change._replace(after=_scale_misalignments(vehicle, change))
    values = {
        quantity.place: quantity.as_yaml
        for quantity in list_changed_quantities(text, vehicle, *straight, notes, source)
        if not quantity.place.startswith(DERIVED_PLACES)
    }
    values |= dict(_list_thrusts(vehicle, change, source))
    values |= dict(_list_part_drags(vehicle, change, source))
    text = set_yaml_values(text, values)
    if change.before.mass == change.after.mass and np.array_equal(
        change.before.inertia, change.after.inertia
    ):
        return text
    return _set_mass_properties(text, vehicle, change.after, source)


@final
class _RotorChange(NamedTuple):
    """What a rotor pushes, by its thrust in the file."""

    thrust: float  # of the thrust in the file; negative if the rotor is the other way round
    reverse: float  # of the reversed wrench in the file, in the direction of which it lies
    backward: Array  # reversed wrench per newton as changed, shape (6,) [1, m]

    @property
    def forward(self) -> float:
        """Thrust for positive duties, of that in the file."""
        return split_by_duty(self.thrust, self.reverse)[0]


def _list_rotor_changes(vehicle: Vehicle, change: VehicleUpdate) -> list[_RotorChange]:
    """Return what each rotor pushes."""
    out = []
    for i, rotor in enumerate(vehicle.rotors, start=1):
        now, before = (
            one.parameter_value(CURVE, f'b_{i}') for one in (change.after, change.before)
        )
        old, new = (np.array(reversed_column(one, i)) for one in (change.before, change.after))
        # Without reverse there is nothing to change
        same = not rotor.reversible or np.array_equal(old, new)
        reverse = 1.0 if same else float(old @ new / (old @ old))
        backward = np.array(rotor.reverse) if same else new
        out.append(_RotorChange(now / before if before else 1.0, reverse, backward))
    return out


def _list_thrusts(
    vehicle: Vehicle, change: VehicleUpdate, source: str
) -> Iterator[tuple[str, Any]]:
    """
    Yield the places of thrust curves and columns of rotors that changed, with their content.

    Control laws need the same curve for all rotors, and a column can also point backwards. So all
    curves have the factor of the strongest rotor, and the column of each its share, -1 to 1.
    """
    rotors = _list_rotor_changes(vehicle, change)
    most = _strongest(rotors)
    curves = {
        f'rotors.{name}.thrust_curve' if rotor.thrust_curve else 'thrust_curve': (
            rotor.thrust_curve or vehicle.file.thrust_curve
        )
        for name, rotor in vehicle.file.rotors.items()
    }
    for place, curve in curves.items():
        if curve is not None and most != 1.0:
            for key in ('a', 'b', 'reverse'):
                if (value := getattr(curve, key)) is not None:
                    thrust = VehicleFileQuantity('', most * value.si, 'N', source)
                    yield f'{place}.{key}', thrust.as_yaml
    coupling = vehicle.file.aero.coupling
    for rotor, now in zip(vehicle.rotors, rotors, strict=True):
        share = now.forward / most
        if share == 1.0 and now.reverse == 1.0:
            continue
        if share != 1.0 and coupling is not None and rotor.name in coupling.rotors:
            raise BadInput(
                f'The rotor {rotor.name} has {100.0 * now.forward:.0f} % of the thrust in the '
                'file, and aero.coupling holds for the thrust in the file; correct the thrust '
                'curve, axis and columns of this rotor in the vehicle file, and calibrate again.'
            )
        yield (
            f'aero.thrust_allocation.{rotor.name}',
            _encode_rotor(vehicle, rotor, now, most, source),
        )


def _strongest(rotors: Sequence[_RotorChange]) -> float:
    """Return the factor on all thrust curves: that of the strongest rotor; 1 if none pushes."""
    return max((abs(one.forward) for one in rotors), default=0.0) or 1.0


def _list_part_drags(
    vehicle: Vehicle, change: VehicleUpdate, source: str
) -> Iterator[tuple[str, Any]]:
    """Yield the drag coefficients of parts whose rotational damping changed, which scale it."""
    before, after = (one.effect_parameters.get(STRIP_EFFECT, {}) for one in change)
    factor = max(
        (after[name] / value for name, value in before.items() if after[name] != value and value),
        default=1.0,
    )
    for layer, parts in vehicle.file.layers.items() if factor != 1.0 else ():
        for name, part in parts.items():
            if part.drag is not None:
                drag = VehicleFileQuantity('', factor * part.drag.coefficient.si, '1', source)
                yield f'layers.{layer}.{name}.drag.coefficient', drag.as_yaml


def _encode_rotor(
    vehicle: Vehicle, rotor: RotorModel, now: _RotorChange, most: float, source: str
) -> Any:
    """Return the column of a rotor by the thrust curve times a factor."""
    entry = vehicle.file.rotors[rotor.name]
    allocation = vehicle.file.aero.thrust_allocation.get(rotor.name)
    jet = (
        (*allocation.force.vector, *allocation.moment.vector)
        if allocation
        else geometric_column(entry)
    )
    # The reader adds the torque of the motor
    torque = np.subtract(rotor.column, jet)
    ahead, back = np.array(rotor.column), now.backward
    curve = entry.thrust_curve or vehicle.file.thrust_curve
    # The reader scales the column of reversed thrust by its full thrust
    full = curve.reverse.si / rotor.full_thrust if curve and curve.reverse else 1.0
    share = now.thrust / most
    if rotor.reversible and share < 0.0:
        ahead, back = back, ahead
    column = _encode_column(share * ahead - torque, source)
    if np.array_equal(ahead, back):
        return column
    return {**column, 'reverse': _encode_column(share * back / full - torque, source)}


def _encode_column(column: Array, source: str) -> dict[str, Any]:
    """Return force and moment of a column."""
    return {
        'force': {'value': column[:3].tolist(), 'unit': 'N/N', 'source': source},
        'moment': {'value': column[3:].tolist(), 'unit': 'm', 'source': source},
    }


def _scale_misalignments(vehicle: Vehicle, change: VehicleUpdate) -> NominalVehicle:
    """Return the changed vehicle with misalignments for the thrust curves of the file."""
    out, rotors = change.after, _list_rotor_changes(vehicle, change)
    most = _strongest(rotors)
    for i, one in enumerate(rotors, start=1):
        share = one.thrust / most
        for name in (f'first_{i}', f'second_{i}'):
            now = out.parameter_value('rotor_misalignment', name)
            if now != 0.0 and share != 1.0:
                out = out.with_value('rotor_misalignment', name, share * now)
    return out


def _set_mass_properties(text: str, vehicle: Vehicle, now: NominalVehicle, source: str) -> str:
    """Return the text with the mass properties of the whole vehicle, less its moving mass."""
    weighed = MassProperties(now.mass, now.cg, now.inertia)
    if vehicle.file.moving_mass is not None:
        # The reader adds it to what was weighed
        mass, *place = (now.parameter_value('moving_mass', name) for name in ('mass', *'xyz'))
        weighed = weighed.with_element(MassElement(-mass, np.array(place), np.zeros(3)))
    inertia = weighed.inertia
    if weighed.mass <= 0.0 or np.linalg.eigvalsh(inertia)[0] <= 0.0:
        raise BadInput(
            f'The calibrated inertia of {vehicle.file.name} is less than that of its moving mass '
            'alone, so it cannot be written; the other values are those of the report.'
        )
    products = [float(inertia[0, 1]), float(inertia[0, 2]), float(inertia[1, 2])]
    quantities = [
        VehicleFileQuantity('measured.mass', float(weighed.mass), 'kg', source),
        VehicleFileQuantity('measured.position', weighed.cg.tolist(), 'm', 'unchanged by the fit'),
        VehicleFileQuantity('measured.inertia', np.diag(inertia).tolist(), 'kg m2', source),
        VehicleFileQuantity('measured.products', products, 'kg m2', source),
    ]
    text = set_yaml_values(text, {one.place: one.as_yaml for one in quantities})
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
    return set_yaml_values(text, {'trim': {**trim, 'heaviness': heavier.as_yaml}})


def format_value(one: CalibratedValue) -> str:
    """Return a value with its interval in words."""
    value, low, high = format_with_interval(one.value, one.ci95)
    return f'{value} {one.unit}, 95 % {low} to {high}'


def format_calibration_source(bags: Sequence[str], commit: str) -> str:
    """Return the source of the calibrated numbers."""
    return f'lta calibrate from {", ".join(bags)}, commit {commit}'


def split_by_duty(thrust: float, reverse: float) -> tuple[float, float]:
    """
    Return the thrust for positive duties, and the share of it for negative ones.

    `thrust`: as a share of that of the file, negative if the rotor is the other way round.
    `reverse`: share of it while it is negative.
    """
    return (thrust * reverse, 1.0 / reverse) if thrust < 0.0 < reverse else (thrust, reverse)


def state_by_duty(
    values: Sequence[CalibratedValue],
    knobs: Sequence[FreeParameter],
    shared: Array,
    covariance: Array,
) -> list[CalibratedValue]:
    """Return the values with those of rotors that the file has the wrong way round by duty."""
    index = {knob.name: k for k, knob in enumerate(knobs)}
    out = {one.name: one for one in values}
    for name in [name for name in index if name.endswith('.reverse')]:
        push = f'{name.removesuffix(".reverse")}.thrust'
        pair = [index[push], index[name]]
        thrust, reverse = 1.0 + shared[pair]
        if not thrust < 0.0 < reverse:
            continue
        # Derivatives of `split_by_duty`
        slopes = np.array([[reverse, thrust], [0.0, -(reverse**-2.0)]])
        spread = slopes @ covariance[np.ix_(pair, pair)] @ slopes.T
        for one, value, variance in zip(
            (push, name), split_by_duty(thrust, reverse), np.diag(spread), strict=True
        ):
            wide = WIDE * math.sqrt(max(float(variance), 0.0))
            ends = (float(value) - wide, float(value) + wide)
            out[one] = replace(out[one], value=float(value), ci95=ends)
    return list(out.values())
