"""Keep the energy books of the drone from its meters, and say when the reserve is reached."""

from typing import TYPE_CHECKING

from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.settings import setting
from lta_energy import messages
from lta_energy.monitoring import alarms
from lta_energy.monitoring.aboard import Aboard
from lta_energy.monitoring.estimate import Estimate
from lta_energy.monitoring.monitor import MonitorSettings, update
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import Parameters
from lta_graph.ros.process import run

if TYPE_CHECKING:
    from lta_graph.inbox import Step
    from nav_msgs.msg import Odometry
    from sensor_msgs.msg import BatteryState, Illuminance


class EnergyMonitorParameters(MonitorSettings):
    """When to come down, and the vehicle whose cell it is."""

    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)


class EnergyMonitor(GraphNode):
    """Answer every battery message with charge, books and reserve, under the same stamp."""

    def __init__(self) -> None:
        super().__init__('energy_monitor')
        self._battery = self.output('energy/battery')
        self._status = self.output('energy/status')
        self._reserve = self.output('energy/reserve')
        self._settings = Parameters(self, EnergyMonitorParameters)
        self._aboard = Aboard.of(load_vehicle_file(self._settings.value.vehicle).energy)
        self._estimate = Estimate()
        self._panel: BatteryState | None = None
        self._light: Illuminance | None = None
        self._odom: Odometry | None = None
        inputs = self.table.read_by('energy_monitor')
        self.listen(inputs, 'battery', self._on_step)

    def _on_step(self, step: 'Step') -> None:
        measured = step.last('battery')
        self._panel = step.last('panel') or self._panel
        self._light = step.last('illuminance') or self._light
        self._odom = step.last('odom') or self._odom
        settings, aboard = self._settings.value, self._aboard
        reading = messages.to_reading(measured, self._panel, self._light, self._odom)
        self._estimate = estimate = update(settings, aboard, self._estimate, reading)
        self._battery.publish(messages.from_charge(aboard.cell, estimate, measured))
        self._status.publish(messages.from_books(settings, aboard, estimate, reading, measured))
        self._reserve.publish(messages.from_reserve(estimate))
        self.health.report('battery', *alarms.battery(settings, aboard.cell, estimate))
        self.health.report('meters', *alarms.meters(estimate))
        self.health.report('way', *alarms.way(estimate))


def main(args: list[str] | None = None) -> None:
    """Run the node until shutdown."""
    run(EnergyMonitor, args)
