# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compute the strips of `strip_damping` from the boxes of a vehicle's frame and panels.

A slim box is one strip along its longest side. A box whose second side is more than half of the
longest is two strips, at the two Gauss points across it (b / sqrt(12) either side of the middle),
each with half of the drag, so a panel is also damped about its long axis. The third side only adds
area.

    D_x = rho C_D (size_y size_z) / 2,   and so on

C_D is 1.17 for a square plate across the flow, 1.98 for a long one (Aeronautical Engineer's Data
Book, figure 5.13(b)). For a box drawn around an open frame, reduce C_D by the solid share.

Collect a vehicle's effects: those derived from its file, and those that it switches on.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import math
from typing import final

from lta_config.constants import STANDARD_GRAVITY
from lta_config.errors import BadInput
from lta_config.quantity import describe_misfit, Quantity, UNSOURCED
from lta_config.schema.vehicle_body import MovingMassBlock, PartBlock
from lta_config.schema.vehicle_file import VehicleFile
from lta_model import effects, mass_properties, propulsion
from lta_model.effects.drag import MOST_STRIPS, STRIP_DAMPING
from lta_model.effects.protocol import AXES, Vector
from lta_model.model import RK4_LIMIT

# Drag coefficient; same source as in the module docstring
SQUARE_PLATE = 1.17


@final
@dataclass(frozen=True, slots=True)
class DragBox:
    """A part in the flow, its sides along the body axes."""

    # Centre from the hull centre, and full lengths of the sides, body frame [m]
    place: Vector
    size: Vector
    coefficient: float = SQUARE_PLATE  # drag coefficient on the area of each side [1]


def _split_box(box: DragBox, density: float) -> list[tuple[float, ...]]:
    """Return the strips of a box, each in the order of the parameters of a strip."""
    x, y, z = box.size
    short, across, along = sorted(range(3), key=lambda axis: box.size[axis])
    del short
    wide = box.size[across] > 0.5 * box.size[along]
    # Gauss points of a uniform width: the same second moment of area
    offset = box.size[across] / math.sqrt(12.0)
    half = [0.0, 0.0, 0.0]
    half[along] = 0.5 * box.size[along]
    sides = (-1.0, 1.0) if wide else (0.0,)
    scale = 0.5 * density * box.coefficient / len(sides)
    strips = []
    for side in sides:
        centre = list(box.place)
        centre[across] += side * offset
        strips.append((*centre, *half, scale * y * z, scale * x * z, scale * x * y))
    return strips


def build_strips(boxes: Sequence[DragBox], density: float) -> dict[str, float]:
    """
    Return all parameters of `strip_damping` for boxes (not the hull), unused strips at zero.

    Raise `BadInput` if they need more strips than the effect has.
    """
    strips = [strip for box in boxes for strip in _split_box(box, density)]
    if len(strips) > MOST_STRIPS:
        raise BadInput(
            f'The {len(boxes)} parts with drag need {len(strips)} strips for their rotational '
            f'damping (a wide part needs two), but the model has only {MOST_STRIPS}; in the '
            'vehicle file, remove drag from some parts, or combine several into one box.'
        )
    # The first parameter is `translation`, 0
    numbers = [0.0, *(number for strip in strips for number in strip)]
    # Unused strips
    numbers += [0.0] * (len(STRIP_DAMPING.parameters) - len(numbers))
    names = (parameter.name for parameter in STRIP_DAMPING.parameters)
    return dict(zip(names, numbers, strict=True))


Effects = dict[str, dict[str, float]]
Numbers = tuple[float, ...]
# Effects with a lag, and the parameter with its time constant.
TIME_CONSTANTS = (
    ('motors', 'motor_lag', 'up'),
    ('motors', 'motor_lag', 'down'),
    ('a moving mass', 'moving_mass', 'lag'),
)
# Hulls round seen from above or from anywhere: drag per axis needs the correction `cross_flow`.
ROUND_HULLS = {'balloon': {'horizontal': 1.0}, 'sphere': {'horizontal': 1.0, 'total': 1.0}}
# Parameters of such an effect that a file may still set: measured roundness, gas that turns.
SETTABLE_SHARES = {'cross_flow': ('horizontal', 'total'), 'gas_rotation': ('share',)}
# Effects that convert duties to newtons instead of the thrust curve.
OTHER_CURVES = ('thrust_polynomial',)


def collect_effects(
    file: VehicleFile,
    rotors: tuple[propulsion.RotorModel, ...],
    added_mass: Numbers,
    air_density: float,
) -> Effects:
    """
    Return the parameters of every effect that is on, in SI units.

    `added_mass` is that of the hull [kg, kg m2]; `air_density` is for the drag of parts [kg/m3].

    Raise `BadInput` if the file switches on an effect derived from other blocks, or sets a
    parameter wrongly.
    """
    derived = _derive_effects(file, rotors, added_mass, air_density)
    for name, values in file.effects.items():
        # A second value for a derived parameter would contradict the blocks that it follows from
        if name in derived and set(values) - set(SETTABLE_SHARES.get(name, ())):
            raise BadInput(
                f'The parameters of the effect {name} in {file.name} are computed from the '
                'blocks hull, parts, rotors or aero of this vehicle file; remove them from its '
                'block effects, and change those blocks instead.'
            )
    own = {name: _check_parameters(name, values) for name, values in file.effects.items()}
    # Own values win only where `SETTABLE_SHARES` allows them
    return derived | {name: derived.get(name, {}) | values for name, values in own.items()}


def check_step(name: str, parameters: Effects, step: float) -> None:
    """Raise `BadInput` for a step [s] above 2.7 time constants of a motor or moving mass."""
    for what, effect, key in TIME_CONSTANTS:
        lag = parameters.get(effect, {}).get(key, 0.0)
        if lag > 0.0 and step > RK4_LIMIT * lag:
            raise BadInput(
                f'{name} has {what} with a time constant of {1e3 * lag:g} ms, too short '
                f'for a simulation time step of {1e3 * step:g} ms; use a time step of '
                f'{1e3 * RK4_LIMIT * lag:.3g} ms or less.'
            )


def _derive_effects(
    file: VehicleFile,
    rotors: tuple[propulsion.RotorModel, ...],
    added_mass: Numbers,
    air_density: float,
) -> Effects:
    linear, quadratic = file.aero.linear_drag, file.aero.quadratic_drag
    faces = parts_drag(file, air_density)
    # Measured drag plus that of the parts it excludes
    forces = tuple(map(sum, zip(quadratic.force.vector, faces, strict=True)))
    derived = {
        'weight_and_buoyancy': {'gravity': STANDARD_GRAVITY},
        'added_mass': _zip_names_values(AXES[:3], added_mass[:3]),
        'added_inertia': _zip_names_values(AXES[3:], added_mass[3:]),
        'linear_drag': _zip_names_values(AXES[:3], linear.force.vector),
        'quadratic_drag': _zip_names_values(AXES[:3], forces),
        'rotational_drag': _zip_names_values(AXES[3:], linear.moment.vector)
        | _zip_names_values([f'{axis}_2' for axis in AXES[3:]], quadratic.moment.vector),
        'rotor_thrust': {
            f'{axis}_{i}': number
            for i, rotor in enumerate(rotors, start=1)
            for axis, number in zip(AXES, rotor.column, strict=True)
        },
    }
    # Without drag there is nothing to correct for oblique flow
    if any(forces) and (round_ := ROUND_HULLS.get(file.hull.shape)):
        derived['cross_flow'] = round_ | _zip_names_values(AXES[:3], forces)
    more = (0.0, 0.0, 0.0)
    if file.hull.shape != 'none':
        gas = mass_properties.gas_mass(file.hull, air_density)
        more = mass_properties.frozen_gas_inertia(gas, mass_properties.half_axes(file.hull))
    derived['gas_rotation'] = _zip_names_values(AXES[3:], more)
    # A second curve would take newtons for duties
    if not any(name in file.effects for name in OTHER_CURVES):
        derived['thrust_curve'] = {
            f'{letter}_{i}': number
            for i, rotor in enumerate(rotors, start=1)
            for letter, number in (('a', rotor.a), ('b', rotor.b))
        }
    if jets := propulsion.interaction_parameters(rotors, file.aero.coupling):
        derived['rotor_envelope_interaction'] = jets
    # Parts already in the aero block still damp rotation
    if turning := [part for part in file.parts.values() if part.drag]:
        derived['strip_damping'] = build_strips(
            [_build_drag_box(part) for part in turning], air_density
        )
    if file.moving_mass:
        derived['moving_mass'] = _moving_mass_parameters(file.moving_mass)
    return derived


def parts_drag(file: VehicleFile, air_density: float) -> Numbers:
    """
    Return D = rho Cd A / 2 along x, y, z of the parts that are not in the aero block.

    It acts at the hull centre, as the rest of the drag does. [N s2/m2].
    """
    total = [0.0, 0.0, 0.0]
    for part in file.parts.values():
        if part.drag and not part.drag.in_aero:
            x, y, z = part.size.vector
            # Area of an ellipse relative to its bounding rectangle
            round_ = math.pi / 4.0 if part.shape == 'shell' else 1.0
            # Faces seen along x, y and z
            for axis, face in enumerate((y * z, x * z, x * y)):
                total[axis] += 0.5 * air_density * part.drag.coefficient.si * round_ * face
    return tuple(total)


def _build_drag_box(part: PartBlock) -> DragBox:
    """Return a part as a source of rotational damping, which steady wind-tunnel data exclude."""
    x, y, z = part.position.vector
    a, b, c = part.size.vector
    return DragBox((x, y, z), (a, b, c), part.drag.coefficient.si if part.drag else 0.0)


def _moving_mass_parameters(moving: MovingMassBlock) -> dict[str, float]:
    """Return the parameters of `moving_mass`; the sender of commands enforces the limits."""
    parameters = dict(zip('xyz', moving.position.vector, strict=True))
    return parameters | {'mass': moving.mass.si, 'lag': moving.time_constant.si}


def _zip_names_values(names: Sequence[str], values: Numbers) -> dict[str, float]:
    return dict(zip(names, values, strict=True))


def _check_parameters(name: str, quantities: Mapping[str, Quantity]) -> dict[str, float]:
    """Return an effect's parameters in SI, each in the unit that the effect declares."""
    declared = {parameter.name: parameter for parameter in effects.get_effect(name).parameters}
    for key, quantity in quantities.items():
        wrong = None if quantity.source else UNSOURCED
        if (
            declaration := declared.get(key)
        ) is not None:  # an unknown parameter is refused by the model
            # The null value is allowed even outside of the bounds
            ends = (
                ()
                if quantity.vector == (declaration.null,)
                else (declaration.low, declaration.high)
            )
            wrong = describe_misfit(quantity, declaration.unit, *ends) or wrong
        if wrong:
            raise BadInput(f'effects.{name}.{key} {wrong}.')
    return {key: quantity.si for key, quantity in quantities.items()}
