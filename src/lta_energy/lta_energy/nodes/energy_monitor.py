# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Run the energy monitor as a ROS node; it reports when the reserve is reached."""

from typing import TYPE_CHECKING, Unpack

from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.settings import setting
from lta_energy import messages
from lta_energy.monitoring.meters import PowerSystem
from lta_energy.monitoring.monitor import EnergyEstimate, MonitorSettings, update_estimate
from lta_energy.monitoring.report import report_energy
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node

if TYPE_CHECKING:
    from geometry_msgs.msg import TwistWithCovarianceStamped
    from lta_graph.lockstep import InboxStep
    from nav_msgs.msg import Odometry


class EnergyMonitorParameters(MonitorSettings):
    """Parameters of the energy monitor node."""

    vehicle: str = setting('gtmab', fixed=True)
    """Vehicle name or file."""


class EnergyMonitor(GraphNode):
    """Answer every battery message with charge, balance and reserve, under the same stamp."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('energy_monitor', **options)
        self._battery = self.create_output('energy/battery')
        self._status = self.create_output('energy/status')
        self._reserve = self.create_output('energy/reserve')
        self._settings = NodeParameters(self, EnergyMonitorParameters)
        self._aboard = PowerSystem.from_entry(
            load_vehicle_file(self._settings.value.vehicle).energy
        )
        self._estimate = EnergyEstimate()
        self._odom: Odometry | None = None
        self._airspeed: TwistWithCovarianceStamped | None = None
        self.subscribe_inputs(
            ['illuminance', 'battery', 'panel', 'odom', 'airspeed'], 'battery', self._on_step
        )

    def _on_step(self, step: 'InboxStep') -> None:
        measured = step.last_message('battery')
        if step.messages['odom']:
            self._odom = step.last_valid('odom')  # None: the position is unknown
        self._airspeed = step.last_valid('airspeed') or self._airspeed
        settings, aboard = self._settings.value, self._aboard
        reading = messages.to_reading(
            measured,
            step.latest['panel'],
            step.latest['illuminance'],
            self._odom,
            self._airspeed,
        )
        self._estimate = estimate = update_estimate(settings, aboard, self._estimate, reading)
        report = report_energy(settings, aboard.cell, estimate)
        self._battery.publish(messages.from_charge(aboard.cell, estimate, measured))
        self._status.publish(
            messages.from_energy_balance(settings, aboard, report, reading, measured)
        )
        self._reserve.publish(messages.from_reserve(estimate))
        self.health.report('battery', *report.battery)
        self.health.report('meters', *report.meters)
        self.health.report('way', *report.way)


def main(args: list[str] | None = None) -> None:
    """Run the node until shutdown."""
    run_node(EnergyMonitor, args)
