# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The parameters of the nodes of estimator, controller and navigator."""

from lta_config.settings import setting, Settings
from lta_control.actions.tasks import TaskLimits
from lta_control.estimator import EstimatorSettings
from lta_control.flight_step import TILT_LIMIT
from lta_control.guidance import ReserveResponseSettings
from lta_control.laws import load_gains
from lta_control.laws.cascade import CascadeGains
from lta_control.mission import MissionSettings


class EstimatorParameters(EstimatorSettings):
    """Settings of the filters, and the vehicle."""

    vehicle: str = setting('gtmab', fixed=True)
    """Vehicle name or file."""


class ControllerSettings(Settings):
    """The vehicle, the gains and the time limits of stale setpoints."""

    vehicle: str = setting('gtmab', fixed=True)
    """Vehicle name or file."""
    law: str = setting('', fixed=True)
    """Name of the control law. Empty: the law named in the vehicle file."""
    scenario: str = setting('', fixed=True)
    """Scenario name or file, whose test signals are added to the duties."""
    armed: bool = setting(False, fixed=True)
    """Whether the motors are armed when the node starts."""
    hold_after: float = setting(0.5, 's', 0.05, 60.0)
    """Age of a setpoint at which the drone holds."""
    land_after: float = setting(3.0, 's', 0.05, 600.0)
    """Age of a setpoint at which the drone lands."""
    tilt_limit: float = setting(TILT_LIMIT, 'rad', 0.1, 3.2)
    """Tilt at which the motors stop."""
    gains: CascadeGains = setting(load_gains('gtmab'))
    """Gains of the cascade law; other laws load their own gains."""


class NavigatorParameters(MissionSettings):
    """The mission and its strategy."""

    vehicle: str = setting('gtmab', fixed=True)
    """Vehicle name or file."""
    strategy: str = setting('homing', fixed=True)
    """Navigation strategy."""
    scenario: str = setting('', fixed=True)
    """Scenario name or file. If it has a course or a route, the drone flies it."""
    commanded: bool = setting(False, fixed=True)
    """
    Whether the drone waits on the ground for the actions take_off, go_to_lamp, go_to_pose,
    follow_path and land. Needs the strategy homing.
    """
    limits: TaskLimits = setting(TaskLimits())
    """Limits of the actions."""
    reserve: ReserveResponseSettings = setting(ReserveResponseSettings())
    """What to do when the charge falls to the energy reserve."""
