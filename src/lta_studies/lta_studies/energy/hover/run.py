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
from lta_flight.ingredients import gather, Ingredients, parts_of
from lta_flight.loop import Loop
from lta_model.electrical.battery import Battery
from lta_model.electrical.loads import Loads
from lta_studies.energy import paper
from lta_studies.energy.flown import Flown, fly, loop_on
from lta_studies.energy.hover.steady import discharged, Trace
import numpy as np

SCENE = 'hall'
RISE = 0.5  # m, seed paper's altitude
GO = 5.0  # s
STEADY = 30.0  # s: from then on it hovers
FULL = {'value': 100, 'unit': '%'}


@final
@dataclass(frozen=True, slots=True)
class Hover:
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
    trace: Trace
    power: float
    energy: float


@final
@dataclass(frozen=True, slots=True)
class Comparison:
    """Two drones on one kind of cell, and the paper's powers on it, by name."""

    seconds: float
    first: Hover
    second: Hover
    paper: Mapping[str, Trace]

    @property
    def share(self) -> float:
        """What the first takes of the second. [1]"""
        return self.first.power / self.second.power


def ingredients(vehicle: str, battery: Any | None = None) -> Ingredients:  # noqa: ANN401 - YAML
    """Return what a hover is made of: a full cell, of another file where one is given."""
    made_of = gather(vehicle, SCENE, 'bag', '')
    scene, body = made_of.contents['scenario'], made_of.contents['vehicle']
    contents = {
        **made_of.contents,
        'scenario': {**scene, 'start': {**scene['start'], 'charge': FULL}},
    }
    if battery is not None:
        contents['vehicle'] = {**body, 'energy': {**body['energy'], 'battery': battery}}
    return replace(made_of, contents=contents)


def compare(first: str, second: str, seconds: float, tick: Callable[[float], None]) -> Comparison:
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
    own = ingredients(first)
    battery = own.contents['vehicle']['energy']['battery']
    cell = parts_of(own)[0].battery
    return Comparison(
        seconds=seconds,
        first=hovering(own, seconds, tick),
        second=hovering(ingredients(second, battery), seconds, tick),
        paper=on_paper(cell, seconds),
    )


def on_paper(cell: Battery, seconds: float) -> dict[str, Trace]:
    """Return the cell under the paper's hover, and under what its third makes a standard drone."""
    return {
        f'paper, {1e3 * power:.0f} mW': discharged(cell, 1.0, power, seconds)
        for power in (paper.HOVER, paper.STANDARD)
    }


def begun(made_of: Ingredients) -> Loop:
    """Return a drone that is about to rise and hover."""
    base = parts_of(made_of)[0].standing_height

    def course(time: float) -> Setpoint:
        return Setpoint(base + (RISE if time >= GO else 0.0), 0.0, 0.0)

    return loop_on(made_of, course, 1)


def hovering(made_of: Ingredients, seconds: float, tick: Callable[[float], None]) -> Hover:
    """Return one drone that hovers until the time [s] is over or its supply fails."""
    told = 0.0

    def over(loop: Loop) -> bool:
        nonlocal told
        elapsed = loop.world.elapsed
        if elapsed - told >= 1.0:
            tick(elapsed - told)
            told = elapsed
        return elapsed >= seconds - 1e-9 or (elapsed > 0.0 and not loop.world.supply.flow.fed)

    loop = begun(made_of)
    flown = fly(loop, over)
    tick(seconds - told)
    failed = None if loop.world.supply.flow.fed else float(flown.time[-1])
    loads = loop.world.vehicle.loads
    return Hover(
        name=loop.world.vehicle.file.name,
        trace=Trace(flown.time[1:], flown.voltage[1:], flown.charge[1:], failed),
        power=mean_power(loads, flown),
        energy=loop.world.supply.books.consumed,
    )


def mean_power(loads: Loads, flown: Flown) -> float:
    """Return the mean of a flight in hover, electronics and radio included. [W]"""
    steady = flown.between(min(STEADY, float(flown.time[-1]) / 2.0), math.inf)
    return loads.idle + loads.transmitting + float(np.mean(steady.rotors))
