# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The algorithms and settings of the drone, and the autopilot built from them."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import final, TYPE_CHECKING

from lta_config.settings import Settings
from lta_control.autopilot import Autopilot, build_drone_constants
from lta_control.estimator import EstimatorSettings
from lta_control.flight_step import TILT_LIMIT
from lta_control.guidance import ReserveResponseSettings
from lta_control.laws import LAWS
from lta_control.laws.protocol import ControlLaw
from lta_control.mission import MissionSettings
from lta_control.motion import Setpoint
from lta_control.strategies.protocol import NavigationStrategy
from lta_energy.monitoring.monitor import MonitorSettings
from lta_model.vehicle import Vehicle
from lta_vlc.lamp import LampPrior
from lta_vlc.settings import DemodulationSettings

if TYPE_CHECKING:  # it loads scipy, which other flights do without
    from lta_flight.recorded_commands import RecordedCommands


@final
@dataclass(frozen=True, slots=True)
class FlightStack:
    """
    All algorithms and settings of the drone.

    `law` is the control law, with `gains` of its own class. `course` gives the setpoint as a
    function of time [s], None before the first one. It replaces the navigator, which then ignores
    the light. `commands` are duties that act instead of those of the controller.
    """

    strategy: NavigationStrategy
    gains: Settings
    estimator: EstimatorSettings = field(default_factory=EstimatorSettings)
    mission: MissionSettings = field(default_factory=MissionSettings)
    demodulation: DemodulationSettings = field(default_factory=DemodulationSettings)
    prior: LampPrior = field(default_factory=LampPrior)
    energy: MonitorSettings = field(default_factory=MonitorSettings)
    reserve: ReserveResponseSettings = field(default_factory=ReserveResponseSettings)
    tilt_limit: float = TILT_LIMIT  # the motors stop beyond it [rad]
    law: ControlLaw = LAWS['cascade']
    course: Callable[[float], Setpoint | None] | None = None
    commands: 'RecordedCommands | None' = None


def build_autopilot(policy: FlightStack, vehicle: Vehicle, dt: float) -> Autopilot:
    """
    Return the autopilot.

    `policy`: law, gains, filters and limits. `vehicle`: the vehicle as the drone knows it. `dt`:
    control period [s].
    """
    drone = build_drone_constants(
        vehicle, policy.estimator, policy.gains, dt, policy.tilt_limit, policy.law
    )
    moving = vehicle.file.moving_mass
    if moving is None:
        return Autopilot(drone, policy.law)
    x, y, z = moving.position.vector
    return Autopilot(drone, policy.law, (x, y, z))
