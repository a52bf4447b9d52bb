# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Hover two drones on the same cell in the closed loop, for as long as in the paper.

The cell is that of the first vehicle's file, full at the start. A drone drops out when its supply
fails and its motors stop.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
import math
from typing import Any, Final, final

from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_spec import build_vehicle_scenario_stack, FlightSpec, load_spec
from lta_model.electrical.battery import BatteryModel
from lta_model.electrical.loads import LoadModel, power_demand
from lta_model.electrical.mppt_charger import advance_power_path, ChargerModel, resting_flow
from lta_report.json_value import ExactArray
from lta_report.study_store import StoreFormat
from lta_report.workers import report_progress
from lta_studies.energy import paper
from lta_studies.energy.course_flight import (
    build_closed_loop,
    build_course,
    FlightTrack,
    fly_until,
)
from lta_vehicle.figures.thrust_envelope import hover_thrust, NOMINAL
import numpy as np
from pydantic import TypeAdapter

DISCHARGE_STEP = 0.1  # s
NO_CHARGER = ChargerModel(tracking=0.0, conversion=0.0, idle=0.0)  # no charging


@final
@dataclass(frozen=True, slots=True)
class DischargeTrace:
    """Voltage [V] and state of charge [1] of a cell over time [s], up to its failure."""

    time: ExactArray
    voltage: ExactArray
    charge: ExactArray
    failed: float | None

    @property
    def voltage_drop(self) -> float:
        """Voltage drop from the first to the last value under load [V]."""
        return float(self.voltage[0] - self.voltage[-1])


def simulate_discharge(
    cell: BatteryModel, charge: float, power: float, seconds: float
) -> DischargeTrace:
    """Discharge a cell from a state of charge [1] at a constant power [W] for a time [s]."""
    flow, rows, failed = resting_flow(charge), [], None
    for k in range(round(seconds / DISCHARGE_STEP)):
        # No light (0 W/m2) and a charger that does nothing
        flow = advance_power_path(cell, NO_CHARGER, flow, 0.0, power, DISCHARGE_STEP)
        if not flow.fed:
            failed = k * DISCHARGE_STEP
            break
        rows.append((k * DISCHARGE_STEP, flow.voltage, flow.charge))
    # The copy makes each column contiguous.
    time, voltage, left = np.array(rows, dtype=np.float64).T.copy()
    return DischargeTrace(time, voltage, left, failed)


HOVER_SCENE = 'hall'
HOVER_ALTITUDE = 0.5  # m, seed paper's altitude
START_TIME = 5.0  # s, take-off
STEADY_TIME = 30.0  # s, start of steady hover
FULL_CHARGE = {'value': 100, 'unit': '%'}


@final
@dataclass(frozen=True, slots=True)
class HoverResult:
    """Hover of one drone."""

    name: str  # name of the vehicle
    trace: DischargeTrace  # voltage and charge of the cell, up to a failure of the supply
    power: float  # mean power in hover [W]
    energy: float  # energy drawn from the cell [J]
    still: float  # power of idling and of the thrust that carries the weight [W]
    radio: float  # power of the radio, in `power` and not in `still` [W]
    capacity: float  # energy of the full cell at its nominal voltage [J]

    @property
    def endurance(self) -> float:
        """Time that a full cell lasts at the power of the hover [s]."""
        return self.capacity / self.power


@final
@dataclass(frozen=True, slots=True)
class HoverComparison:
    """Hover of two drones, and the same cell under the paper's powers, by name."""

    seconds: float
    first: HoverResult
    second: HoverResult
    paper: Mapping[str, DischargeTrace]

    @property
    def power_ratio(self) -> float:
        """Power of the first drone relative to the second [1]."""
        return self.first.power / self.second.power


def build_hover_spec(vehicle: str, battery: Any | None = None) -> FlightSpec:
    """Return the spec of a hover with a full cell, optionally replaced by `battery`."""
    made_of = load_spec(vehicle, HOVER_SCENE, 'bag', '')
    scene, body = made_of.contents['scenario'], made_of.contents['vehicle']
    contents = {
        **made_of.contents,
        'scenario': {**scene, 'start': {**scene['start'], 'charge': FULL_CHARGE}},
    }
    if battery is not None:
        contents['vehicle'] = {**body, 'energy': {**body['energy'], 'battery': battery}}
    return replace(made_of, contents=contents)


HOVER_STORE: Final = StoreFormat(
    'hovers.jsonl', 'hover', 'power budget', TypeAdapter(HoverResult), shares_folder=True
)


@final
@dataclass(frozen=True, slots=True)
class HoverStudy:
    """Hover of two vehicles (names or files) on the first one's cell, for a time [s]."""

    vehicle: str
    multirotor: str
    seconds: float = paper.HOVER_TIME

    def build_specs(self) -> list[FlightSpec]:
        """Return the specs of both hovers."""
        own = build_hover_spec(self.vehicle)
        battery = own.contents['vehicle']['energy']['battery']
        return [own, build_hover_spec(self.multirotor, battery)]

    def fly(self, drone: int) -> HoverResult:
        """Hover the first drone (0) or the second (1); workers call this."""
        return fly_hover(self.build_specs()[drone], self.seconds, report_progress)

    def compare(self, hovers: Sequence[HoverResult]) -> HoverComparison:
        """Compare both hovers with each other and with the paper's powers."""
        cell = build_vehicle_scenario_stack(self.build_specs()[0])[0].battery
        first, second = hovers
        paper_traces = simulate_paper_hover(cell, self.seconds)
        return HoverComparison(self.seconds, first, second, paper_traces)


def simulate_paper_hover(cell: BatteryModel, seconds: float) -> dict[str, DischargeTrace]:
    """Discharge the cell at the paper's hover power, and at that of a standard drone."""
    return {
        f'paper, {1e3 * power:.0f} mW': simulate_discharge(cell, 1.0, power, seconds)
        for power in (paper.HOVER, paper.STANDARD)
    }


def prepare_hover(spec: FlightSpec) -> ClosedLoop:
    """Return the closed loop of a hover before its first step."""
    base = build_vehicle_scenario_stack(spec)[0].hull_height_on_floor
    return build_closed_loop(spec, build_course(base, HOVER_ALTITUDE, START_TIME), 1)


def fly_hover(
    spec: FlightSpec, seconds: float, report: Callable[[float], None] = lambda share: None
) -> HoverResult:
    """Hover until the time [s] is over or the supply fails; report the share that is over."""
    reported = 0.0

    def is_over(loop: ClosedLoop) -> bool:
        nonlocal reported
        elapsed = loop.world.elapsed
        # Report once per simulated second, as a call per step would slow the flight.
        if elapsed - reported >= 1.0:
            report(elapsed / seconds)
            reported = elapsed
        # Before the first step the supply has not been computed yet.
        return elapsed >= seconds - 1e-9 or (elapsed > 0.0 and not loop.world.supply.flow.fed)

    loop = prepare_hover(spec)
    record = fly_until(loop, is_over)
    failed = None if loop.world.supply.flow.fed else float(record.time[-1])
    loads = loop.world.vehicle.loads
    each, count = hover_thrust(loop.world.vehicle)
    return HoverResult(
        name=loop.world.vehicle.file.name,
        # Without the first sample, which precedes the first load
        trace=DischargeTrace(record.time[1:], record.voltage[1:], record.charge[1:], failed),
        power=mean_hover_power(loads, record),
        energy=loop.world.supply.energy_totals.consumed,
        still=power_demand(loads, [each] * count, transmitting=False),
        radio=loads.transmitting,
        capacity=loop.world.vehicle.file.energy.battery.capacity.si * NOMINAL,
    )


def mean_hover_power(loads: LoadModel, track: FlightTrack) -> float:
    """Return the mean hover power, including electronics and radio [W]."""
    # A drone that failed before STEADY is averaged over its second half.
    steady = track.crop(min(STEADY_TIME, float(track.time[-1]) / 2.0), math.inf)
    return loads.idle + loads.transmitting + float(np.mean(steady.rotors))
