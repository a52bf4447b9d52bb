# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Use the simulated drone as the body of an emulated Crazyflie."""

from collections.abc import Callable, Mapping
import math
from typing import Any, final

from lta_bridge.crazyflie.duties_packet import find_rotor_indices
from lta_config.constants import STANDARD_GRAVITY
from lta_config.errors import BadInput
from lta_config.schema.crazyflie_file import CrazyflieFile, hash_airframe
from lta_config.topics import TopicTable
from lta_control.allocation import create_working_array
from lta_control.laws import find_control_law, load_law_gains
from lta_control.laws.protocol import LawInputs
from lta_control.motion import ControlMotion, Setpoint, yaw_from_quaternion
from lta_emulation.crazyflie.commander import BodyCommand, HoverSetpoint
from lta_emulation.crazyflie.parameters import select_build
from lta_model.vehicle import Vehicle
from lta_sim.world import World


@final
class VehicleLaw:
    """
    A control law with its state.

    Parameters
    ----------
    vehicle : Vehicle
        Its file defines law and gains.

    Raises
    ------
    BadInput
        If it defines none.

    """

    def __init__(self, vehicle: Vehicle) -> None:
        control = vehicle.file.control
        if control is None or control.gains is None:
            raise BadInput(
                f'The vehicle {vehicle.file.name} has no control law with gains; add a "control" '
                'block to its file, or use command:=motors.'
            )
        self._law = find_control_law(control.law)
        self._constants = self._law.build_constants(
            load_law_gains(self._law.gains, control.gains), vehicle
        )
        self._memory: Any = self._law.start
        # Work arrays of the allocation, created once
        self._scratch = create_working_array()

    def step(self, motion: ControlMotion, setpoint: Setpoint, dt: float) -> tuple[float, ...]:
        """Return the duties by slot after one more period [s]."""
        inputs = LawInputs(motion, setpoint, dt)
        self._memory = self._law.step(self._constants, self._memory, inputs, self._scratch)
        duties: tuple[float, ...] = self._memory.command.duties
        return duties

    def reset(self) -> None:
        """Reset the integrators."""
        self._memory = self._law.start


LANDING_SINK_RATE = 0.3  # m/s, sink rate of a landing
TOUCH = 0.03  # m above the floor, below which a landing is complete
PACKED_RANGE = 65.535  # m, largest range in 16 bits of millimetres
PWM_STEP = 1.0 / 256.0  # duty: the motors' PWM has 8 bits (motors.c)
SLIP = 20  # control periods; a longer delay is skipped instead of caught up


@final
class SimulatedBody:
    """
    Step a `World` in real time.

    The correction of duties for the battery's voltage is part of the vehicle model (the effect
    `battery_compensation`); `duties` are those before the correction.

    Parameters
    ----------
    file : CrazyflieFile
        Wiring of motors and rotors. With setpoints, the vehicle's control law replaces the
        firmware's controller.
    table : TopicTable
        The control period.
    light : callable, optional
        Called with each light block and the time of its first sample since boot [s], for the
        emulated light board.

    Attributes
    ----------
    build : Build
        Build of the firmware to emulate.

    """

    def __init__(
        self,
        world: World,
        file: CrazyflieFile,
        table: TopicTable,
        light: Callable[[float, Any], None] | None = None,
    ) -> None:
        self._world, self._dt, self._light = world, 1e-9 * table.control_ns, light
        self._start_ns = table.start_ns
        vehicle = world.vehicle
        self._order = find_rotor_indices(file.motors, vehicle.rotor_names)
        self.build = select_build(file.command)._replace(
            airframe=hash_airframe(vehicle.file, file)
        )
        self._law = VehicleLaw(vehicle) if file.command == 'setpoint' else None
        self.duties: tuple[float, ...] = (0.0,) * len(self._order)
        self._values: dict[str, float] = {}
        self._setpoint = Setpoint(0.0, 0.0, 0.0)
        self._behind = 0.0  # s by which the world started late or fell behind
        self._update_log_values()

    @property
    def world(self) -> World:
        """Return the simulated world."""
        return self._world

    def read_log_values(self) -> Mapping[str, float]:
        """Return the newest values, in the firmware's units."""
        return self._values

    def advance(self, now: float, wish: BodyCommand) -> None:
        """Advance to a time [s]; skip a long delay."""
        late = now - self._behind - self._world.elapsed
        if late > SLIP * self._dt:
            # Shift the time base instead: catching up would make the drone jump
            self._behind += late - self._dt
        # 1e-9 s: a step that ends exactly now is due despite rounding
        while self._world.elapsed + self._dt <= now - self._behind + 1e-9:
            self._step_world(wish)

    def _step_world(self, wish: BodyCommand) -> None:
        rotors = [0.0] * len(self._world.vehicle.rotor_names)
        if wish.duties is not None:
            for place, duty in zip(self._order, wish.duties, strict=True):
                rotors[place] = duty
        elif self._law is not None and (wish.hover is not None or wish.land):
            rotors = list(self._compute_duties(wish.hover)[: len(rotors)])
        elif self._law is not None:
            # Without a command the integrators must not keep the last flight's values
            self._law.reset()
        for place in self._order:
            rotors[place] = max(wish.idle, rotors[place])
        self.duties = tuple(rotors[place] for place in self._order)
        # Duties below one PWM step do not turn a motor
        self._world.advance([duty if duty >= PWM_STEP else 0.0 for duty in rotors])
        if self._law is not None and not any(self.duties) and self._is_on_floor:
            self._level_attitude()
        self._update_log_values()

    @property
    def _is_on_floor(self) -> bool:
        return bool(self._world.state[2] < self._world.vehicle.hull_height_on_floor + TOUCH)

    def _level_attitude(self) -> None:
        """Level the drone on the floor, where the world supports it at one point only."""
        state = self._world.state
        half = 0.5 * yaw_from_quaternion(state[3:7].tolist())
        state[3:7] = 0.0, 0.0, math.sin(half), math.cos(half)
        # Body rates; state[3:7] is the quaternion x y z w
        state[10:13] = 0.0

    def _compute_duties(self, hover: HoverSetpoint | None) -> tuple[float, ...]:
        """Return the law's duties for a hover; without one, for a vertical descent."""
        assert self._law is not None
        state = self._world.state.tolist()
        position, turn = tuple(state[:3]), tuple(state[3:7])
        motion = ControlMotion(position, turn, tuple(state[7:10]), tuple(state[10:13]))
        if hover is None:
            height = self._setpoint.altitude - LANDING_SINK_RATE * self._dt
            if self._is_on_floor:
                return (0.0,) * len(self._world.vehicle.rotor_names)
            self._setpoint = Setpoint(height, self._setpoint.heading, 0.0)
        else:
            # The law has a heading setpoint: aim one second of the yaw rate ahead
            heading = yaw_from_quaternion(turn) + hover.yaw_rate
            self._setpoint = Setpoint(hover.height, heading, hover.forward)
        return self._law.step(motion, self._setpoint, self._dt)

    def _update_log_values(self) -> None:
        readings = self._world.sense_motion()
        self._world.sense_rest(readings)
        values = self._values
        for axis, force, rate in zip('xyz', readings.force, readings.rates, strict=True):
            # The firmware logs g, deg/s, mm, mbar and V
            values[f'acc.{axis}'] = force / STANDARD_GRAVITY
            values[f'gyro.{axis}'] = math.degrees(rate)
        if readings.ranges:
            distance = min(max(readings.ranges[-1][1], 0.0), PACKED_RANGE)
            values['range.zrange'] = 1e3 * distance
        if readings.pressure is not None:
            values['baro.pressure'] = 1e-2 * readings.pressure
        if readings.battery is not None:
            values['pm.vbat'] = readings.battery[0]
        values['stateEstimate.yaw'] = math.degrees(
            yaw_from_quaternion(self._world.state[3:7].tolist())
        )
        values['stabilizer.yaw'] = values['stateEstimate.yaw']
        for axis, where in zip('xyz', self._world.state[:3].tolist(), strict=True):
            values[f'stateEstimate.{axis}'] = values[f'kalman.state{axis.upper()}'] = where
        if readings.block is not None and self._light is not None:
            begun_ns, block = readings.block
            # Simulation time to time since boot
            self._light(1e-9 * (begun_ns - self._start_ns) + self._behind, block)
