"""
Both drones hover on the same cell, in the closed loop, for as long as the paper's did.

The cell is that of the first vehicle's file, full at the start. A drone whose supply fails falls
out of the comparison at that time: its motors stop.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
import math
from typing import Any, final

from lta_control.cascade import Setpoint
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_spec import build_parts, FlightSpec, load_spec
from lta_model.electrical.battery import BatteryModel
from lta_model.electrical.loads import LoadModel
from lta_studies.energy import paper
from lta_studies.energy.course_flight import build_loop, FlightTrack, fly_until
from lta_studies.energy.hover.discharge import DischargeTrace, simulate_discharge
import numpy as np

SCENE = 'hall'
RISE = 0.5  # m, seed paper's altitude
GO = 5.0  # s
STEADY = 30.0  # s: from then on it hovers
FULL = {'value': 100, 'unit': '%'}


@final
@dataclass(frozen=True, slots=True)
class HoverResult:
    """
    One drone on its cell.

    Attributes
    ----------
    name : str
        Of the vehicle.
    trace : Trace
        The cell's voltage and charge, up to where its supply failed.
    power : float
        Mean in hover. [W]
    energy : float
        Drawn from the cell's terminals. [J]

    """

    name: str
    trace: DischargeTrace
    power: float
    energy: float


@final
@dataclass(frozen=True, slots=True)
class HoverComparison:
    """Two drones on one kind of cell, and the paper's powers on it, by name."""

    seconds: float
    first: HoverResult
    second: HoverResult
    paper: Mapping[str, DischargeTrace]

    @property
    def power_share(self) -> float:
        """What the first takes of the second. [1]"""
        return self.first.power / self.second.power


def build_hover_spec(vehicle: str, battery: Any | None = None) -> FlightSpec:  # noqa: ANN401 - YAML
    """Return what a hover is made of: a full cell, of another file where one is given."""
    made_of = load_spec(vehicle, SCENE, 'bag', '')
    scene, body = made_of.contents['scenario'], made_of.contents['vehicle']
    contents = {
        **made_of.contents,
        'scenario': {**scene, 'start': {**scene['start'], 'charge': FULL}},
    }
    if battery is not None:
        contents['vehicle'] = {**body, 'energy': {**body['energy'], 'battery': battery}}
    return replace(made_of, contents=contents)


def compare_hovering(
    first: str, second: str, seconds: float, tick: Callable[[float], None]
) -> HoverComparison:
    """
    Return two drones that hover on the same cell.

    Parameters
    ----------
    first, second : str
        Vehicles, names or files; the cell is the first one's.
    seconds : float
        How long. [s]
    tick : callable
        Told how much of the flights has been flown since it was told last. [s]

    """
    own = build_hover_spec(first)
    battery = own.contents['vehicle']['energy']['battery']
    cell = build_parts(own)[0].battery
    return HoverComparison(
        seconds=seconds,
        first=fly_hover(own, seconds, tick),
        second=fly_hover(build_hover_spec(second, battery), seconds, tick),
        paper=simulate_paper_hover(cell, seconds),
    )


def simulate_paper_hover(cell: BatteryModel, seconds: float) -> dict[str, DischargeTrace]:
    """Return the cell under the paper's hover, and under what its third makes a standard drone."""
    return {
        f'paper, {1e3 * power:.0f} mW': simulate_discharge(cell, 1.0, power, seconds)
        for power in (paper.HOVER, paper.STANDARD)
    }


def prepare_hover(spec: FlightSpec) -> ClosedLoop:
    """Return a drone that is about to rise and hover."""
    base = build_parts(spec)[0].height_on_floor

    def setpoint_at(time: float) -> Setpoint:
        return Setpoint(base + (RISE if time >= GO else 0.0), 0.0, 0.0)

    return build_loop(spec, setpoint_at, 1)


def fly_hover(spec: FlightSpec, seconds: float, tick: Callable[[float], None]) -> HoverResult:
    """Return one drone that hovers until the time [s] is over or its supply fails."""
    told = 0.0

    def is_over(loop: ClosedLoop) -> bool:
        nonlocal told
        elapsed = loop.world.elapsed
        if elapsed - told >= 1.0:
            tick(elapsed - told)
            told = elapsed
        return elapsed >= seconds - 1e-9 or (elapsed > 0.0 and not loop.world.supply.flow.fed)

    loop = prepare_hover(spec)
    flown = fly_until(loop, is_over)
    tick(seconds - told)
    failed = None if loop.world.supply.flow.fed else float(flown.time[-1])
    loads = loop.world.vehicle.loads
    return HoverResult(
        name=loop.world.vehicle.file.name,
        trace=DischargeTrace(flown.time[1:], flown.voltage[1:], flown.charge[1:], failed),
        power=mean_hover_power(loads, flown),
        energy=loop.world.supply.energy_books.consumed,
    )


def mean_hover_power(loads: LoadModel, track: FlightTrack) -> float:
    """Return the mean of a flight in hover, electronics and radio included. [W]"""
    steady = track.crop(min(STEADY, float(track.time[-1]) / 2.0), math.inf)
    return loads.idle + loads.transmitting + float(np.mean(steady.rotors))
