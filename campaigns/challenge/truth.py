# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Define the true parameters of a vehicle, the air around it and its sensors."""

from dataclasses import dataclass
import math
from typing import Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_model.vehicle import Vehicle

Triple = tuple[float, float, float]
Six = tuple[float, float, float, float, float, float]

NONE: Final[Triple] = (0.0, 0.0, 0.0)


@final
class DragPlate(NamedTuple):
    """A part that damps rotation: centre and half extent [m], drag along each axis [N s2/m2]."""

    place: Triple
    reach: Triple
    drag: Triple


@final
@dataclass(frozen=True, slots=True)
class VehicleTruth:
    """
    True parameters of one flight.

    Body axes are x forward, y left, z up, with their origin at the centre of the hull.
    """

    mass: float  # with its gas [kg]
    displaced: float  # mass of the displaced air [kg]
    cg: Triple  # centre of gravity [m]
    inertia: Triple  # about the centre of gravity [kg m2]
    added_mass: Triple  # [kg]
    added_inertia: Triple  # [kg m2]
    drag: Triple  # quadratic [N s2/m2]
    turn_linear: Triple  # damping of rotation [N m s]
    turn_square: Triple  # damping of rotation [N m s2]
    plates: tuple[DragPlate, ...]  # parts that damp rotation by their own drag
    curve: tuple[float, float]  # a and b of T = a u^2 + b u [N]
    columns: tuple[Six, ...]  # force and moment per newton of each rotor [1], [m]
    places: tuple[Triple, ...]  # positions of the rotors [m]
    gains: tuple[float, ...]  # factor on the thrust of each rotor
    imu_place: Triple  # position of the IMU [m]
    range_place: Triple  # position of the range sensor [m]
    lag: float = 0.072  # time constant of the motors [s]
    yaw_air: float = 0.0  # hidden added inertia in yaw, which grows with the rate [kg m2]
    linear_drag: Triple = NONE  # [N s/m]
    extra_drag: Triple = NONE  # hidden quadratic drag [N s2/m2]
    munk: float = 1.0  # share of the Munk moment that acts
    # Normal force of the hull by v_h v_z [N s2/m2], and its loss by the squared sine of incidence
    normal: float = 0.0
    stall: float = 0.0
    lift: float = 0.0  # upward force at the hull centre [N]
    leak: float = 0.0  # loss of lift per time [N/s]
    thrust: float = 1.0  # factor on the thrust of all rotors
    slow_lag: float = 0.0  # hidden increase of the motors' time constant [s]
    delay: float = 0.0  # from a command to the motors [s]
    deadband: float = 0.0  # duty below which a rotor stands still
    wind: Triple = NONE  # mean wind in the map [m/s]
    draught: float = 0.0  # root mean square of each component of the random air motion [m/s]
    tracker: Triple = NONE  # yaw, pitch and roll from the tracker's axes to the map [rad]
    tracker_delay: float = 0.0  # age of a pose [s]
    # Yaw, pitch and roll from the axes of the marker frame to the body's [rad]
    marker_turn: Triple = NONE
    marker_arm: Triple = NONE  # position of the marker frame's origin in the body [m]
    # Share of a commanded wrench that acts, by axis; of vehicles without duties
    wrench_gains: Six = (1.0, 1.0, 1.0, 1.0, 1.0, 1.0)
    imu_bias: Triple = NONE  # [m/s2]
    gyro_bias: Triple = NONE  # [rad/s]
    gyro_scale: Triple = NONE  # relative scale error of the gyroscope [1]
    range_offset: float = 0.0  # bias [m]
    pressure_offset: float = 0.0  # bias [Pa]


def to_triple(values: object) -> Triple:
    """Convert three numbers to a tuple of floats."""
    x, y, z = (float(each) for each in values)  # type: ignore[attr-defined]
    return x, y, z


def spheroid_added_mass(diameter: float, height: float, density: float) -> tuple[Triple, Triple]:
    """
    Return the added mass and inertia of an oblate spheroid.

    Lamb, Hydrodynamics, 6th edition, sections 114 and 115.

    Parameters
    ----------
    diameter, height : float
        Size across and along its axis, z. [m]
    density : float
        Density of the air. [kg/m3]

    Returns
    -------
    pair of triple
        For translation [kg] and rotation [kg m2] along x, y and z.

    """
    a, c = 0.5 * diameter, 0.5 * height
    fluid = 4.0 / 3.0 * math.pi * a * a * c * density
    # Eccentricity of the meridian
    e = math.sqrt(1.0 - (c / a) ** 2)
    flat = c / a
    across = flat / e**3 * math.asin(e) - flat**2 / e**2
    along = 2.0 / e**2 * (1.0 - flat / e * math.asin(e))
    edge, broad = fluid * across / (2.0 - across), fluid * along / (2.0 - along)
    less, more = a * a - c * c, a * a + c * c
    tumbling = 0.2 * fluid * less**2 * (along - across) / (2.0 * less - more * (along - across))
    # Rotation about the axis of symmetry moves no air in potential flow
    return (edge, edge, broad), (tumbling, tumbling, 0.0)


def build_drag_plates(vehicle: Vehicle) -> tuple[DragPlate, ...]:
    """Return the parts that damp rotation; the aero block has their drag in straight flight."""
    out = []
    for part in vehicle.file.parts.values():
        # Only parts whose drag in straight flight is contained in the aero block
        if part.drag and part.drag.in_aero and part.size:
            x, y, z = to_triple(part.size.vector)
            each = 0.5 * vehicle.air_density * part.drag.coefficient.si
            # Frontal area of the box along each axis
            drag = (each * y * z, each * z * x, each * x * y)
            longest = max(x, y, z)
            # Integrate along the longest side only
            reach = to_triple(0.5 * side if side == longest else 0.0 for side in (x, y, z))
            out.append(DragPlate(to_triple(part.position.vector), reach, drag))
    return tuple(out)


def build_vehicle_truth(vehicle: Vehicle) -> VehicleTruth:
    """Return the parameters of a vehicle file; raise `BadInput` if its shape is not supported."""
    file = vehicle.file
    diameter, height = file.hull.diameter, file.hull.height
    if diameter is None or height is None or height.si >= diameter.si or len(file.rotors) != 4:
        raise BadInput(
            'The independent simulator needs a hull that is wider than high, and four rotors; '
            f"vehicle '{file.name}' differs, so choose another vehicle."
        )
    added = spheroid_added_mass(diameter.si, height.si, vehicle.air_density)
    linear, square = file.aero.linear_drag, file.aero.quadratic_drag
    effects = vehicle.collect_effects()
    oblique, gas = effects.get('oblique_lift', {}), effects['gas_rotation']
    # The gas slips along the hull, but for what its boundary layer drags
    turning = [gas.get('share', 0.0) * gas[axis] for axis in ('roll', 'pitch', 'yaw')]
    columns = tuple(
        (*to_triple(each.force.vector), *to_triple(each.moment.vector))
        for each in file.aero.thrust_allocation.values()
    )
    return VehicleTruth(
        mass=vehicle.mass,
        displaced=vehicle.displaced_mass,
        cg=to_triple(vehicle.cg),
        inertia=to_triple(vehicle.inertia.diagonal() + turning),
        added_mass=added[0],
        added_inertia=added[1],
        drag=to_triple(square.force.vector),
        linear_drag=to_triple(linear.force.vector),
        turn_linear=to_triple(linear.moment.vector),
        turn_square=to_triple(square.moment.vector),
        plates=build_drag_plates(vehicle),
        curve=vehicle.thrust_curve,
        columns=columns,
        places=tuple(to_triple(one.position.vector) for one in file.rotors.values()),
        gains=(1.0,) * len(columns),
        imu_place=to_triple(file.sensors.imu_position.vector),
        range_place=to_triple(file.sensors.range_position.vector),
        lag=effects['motor_lag']['up'],
        munk=1.0 - effects.get('munk_moment', {}).get('lost', 0.0),
        normal=oblique.get('lift', 0.0),
        stall=oblique.get('stall', 0.0),
    )
