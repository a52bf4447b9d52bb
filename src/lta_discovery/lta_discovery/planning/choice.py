"""
Choose the flight that decides between names: each is supposed, flown in process, and compared.

Manoeuvres are flown as the vehicle file has it, the cheapest first. One that promises enough is
flown again with each name supposed to be the truth; only what is safe and decides then is chosen.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final, final, NamedTuple

from lta_config.errors import BadInput, unknown
from lta_discovery.fit.evidence import floor_of, Pieces, Reduced
from lta_discovery.model.knobs import Knob, knobs
from lta_discovery.model.nominal import Nominal
from lta_discovery.planning.flyable import extent, objections
from lta_discovery.planning.manoeuvres import DEEP, family, HIGH, Manoeuvre, Space
from lta_discovery.planning.pairs import Pairs
from lta_discovery.planning.rehearsal import along, prepared, rehearse, Rehearsed, Sensors
from lta_discovery.planning.supposed import supposed
from lta_discovery.replay.linear import origin
from lta_discovery.replay.linearise import Linearised
from lta_flight.ingredients import Ingredients, parts_of
from lta_model.scenario import Scenario
from lta_model.vehicle import Vehicle
from lta_sim.in_scene import reach
import numpy as np
from numpy.typing import NDArray
import yaml

Array = NDArray[np.float64]
Tell = Callable[[str, float | None], None]

WANTED: Final = 12.0  # nats to expect: 3 decide, and what comes spreads by the root of twice this
LEAST: Final = 6.0  # nats; a flight that promises less is not worth it
TRIED: Final = 4  # manoeuvres that are flown with each name supposed
SURE: Final = 1.3  # of what is wanted, that a manoeuvre has to promise at the first glance
SEED: Final = 71


class Rival(NamedTuple):
    """A name and its value in the unit of its knob."""

    knob: Knob
    value: float


@final
@dataclass(frozen=True, slots=True)
class Chosen:
    """
    The flight that decides.

    Attributes
    ----------
    manoeuvre : Manoeuvre
        What it does.
    nats : float
        Log Bayes factor to expect of the true name over the other, of the pair that is least
        told apart, when it is flown twice.
    space : tuple of three floats
        Length, width and height that it takes. [m]
    made : Ingredients
        All that decides the flight; the scenario is among it.

    """

    manoeuvre: Manoeuvre
    nats: float
    space: tuple[float, float, float]
    made: Ingredients


@final
class Planner:
    """
    A vehicle, its scene and what is known already.

    Parameters
    ----------
    made : Ingredients
        Vehicle, scene and pilot.
    text : str
        The vehicle file.
    sensors : str
        What will be recorded: 'all', 'imu', 'pose'.
    flown : sequence of Reduced
        Flights that there are, about the vehicle file.
    tell : callable
        Told what is being done.

    """

    def __init__(
        self,
        made: Ingredients,
        text: str,
        sensors: Sensors = 'all',
        flown: Sequence[Reduced] = (),
        tell: Tell = lambda _words, _share: None,
    ) -> None:
        self.made, self.sensors, self.flown, self._tell = made, sensors, list(flown), tell
        self.vehicle, scenario, _ = parts_of(made)
        self.text, self.nominal = text, Nominal.of(self.vehicle)
        self.knobs = knobs(self.nominal)
        self._names = [knob.name for knob in self.knobs]
        self._floor = floor_of(self.nominal)
        standing, top = self.vehicle.standing_height, scenario.room.size.vector[2]
        highest = top - reach(self.vehicle)[1] - 0.6
        self.space = Space(standing + DEEP, min(standing + HIGH, highest))
        if self.space.high < standing + 2.0 * DEEP:
            raise BadInput(
                f'The scenario {scenario.name} is {top:g} m high, too low to fly '
                f'{self.vehicle.file.name} in; plan in another with --scenario.'
            )

    def knob(self, name: str) -> Knob:
        """Return a knob by name; `BadInput` that lists the known ones."""
        if name not in self._names:
            known = [knob.name for knob in self.knobs if knob.typical > 0.0]
            raise unknown('effect', name, known)
        return self.knobs[self._names.index(name)]

    def mimic(self, first: Rival, other: Knob) -> Rival:
        """Return the value at which another name looks most like a first, in what was flown."""
        a, b = self._names.index(first.knob.name), self._names.index(other.name)
        value = other.typical
        if self.flown:
            pair = Pairs(self.flown, self.knobs).pair(a, b)
            if pair.second > 0.0:
                value = first.value * pair.shared / pair.second
        within = float(np.clip(value, other.low, other.high))
        return Rival(other, within if within != 0.0 else other.typical)

    def choose(self, first: Rival, others: Sequence[Rival]) -> Chosen | None:
        """
        Return the cheapest flight that decides; None where none in the family does safely.

        Parameters
        ----------
        first : Rival
            The name that was found, and its value.
        others : sequence of Rival
            Names that may be meant instead.

        """
        rest: list[tuple[float, Manoeuvre]] = []
        for one in family(self.space):
            self._tell(f'flying in thought: {one.about}', None)
            nats = self.promised(one, first, others)
            if nats is None:
                continue
            chosen = self._decided(one, first, others) if nats > SURE * WANTED else None
            if chosen is not None and chosen.nats >= WANTED:
                return chosen
            rest.append((nats if chosen is None else chosen.nats, one))
        rest.sort(key=lambda pair: -pair[0])
        tried = [self._decided(one, first, others) for _, one in rest[:TRIED]]
        found = [one for one in tried if one is not None and one.nats >= LEAST]
        return max(found, key=lambda one: one.nats, default=None)

    def promised(
        self, manoeuvre: Manoeuvre, first: Rival, others: Sequence[Rival]
    ) -> float | None:
        """Return what a manoeuvre promises as the file has the vehicle; None where unsafe."""
        made = along(self.made, manoeuvre.course, manoeuvre.length)
        flown, scenario = self._fly(made, self.vehicle)
        if objections(flown, self.vehicle, scenario):
            return None
        reduced = self._reduced(flown, self.nominal)
        pairs = [(first, other) for other in others] + [(other, first) for other in others]
        return min(self.nats(reduced, *pair) for pair in pairs)

    def _decided(
        self, manoeuvre: Manoeuvre, first: Rival, others: Sequence[Rival]
    ) -> Chosen | None:
        """Return a manoeuvre if it is safe whichever name is true, and what it promises then."""
        made = along(self.made, manoeuvre.course, manoeuvre.length)
        least, spaces = np.inf, []
        for true in (first, *others):
            try:
                vehicle, flown, reduced = self._supposed(made, true)
            except BadInput:
                return None
            scenario = parts_of(made)[1]
            if objections(flown, vehicle, scenario):
                return None
            spaces.append(extent(flown, vehicle))
            against = others if true is first else (first,)
            least = min(least, *(self.nats(reduced, true, other) for other in against))
        x, y, z = np.max(spaces, axis=0).tolist()
        return Chosen(manoeuvre, float(least), (x, y, z), made)

    def _supposed(self, made: Ingredients, true: Rival) -> tuple[Vehicle, Rehearsed, Reduced]:
        """Fly with a name supposed to be the truth; the pilot knows the file."""
        nominal = true.knob.turned(self.nominal, true.value)
        content: Any = yaml.safe_load(supposed(self.text, self.vehicle, nominal))
        changed = Ingredients(
            made.names, made.strategy, {**made.contents, 'vehicle': content}, made.replaced
        )
        vehicle = parts_of(changed)[0]
        flown, _ = self._fly(made, vehicle)
        return vehicle, flown, self._reduced(flown, nominal)

    def _fly(self, made: Ingredients, vehicle: Vehicle) -> tuple[Rehearsed, Scenario]:
        """Fly once, the pilot knowing the vehicle file."""
        known, scenario, policy = parts_of(made)
        return rehearse(vehicle, scenario, policy, SEED, Vehicle(known.file)), scenario

    def _reduced(self, flown: Rehearsed, nominal: Nominal) -> Reduced:
        """Return what a flight in thought says, about a vehicle."""
        flight = prepared(flown.streams, self.vehicle, self.knobs, self.sensors)
        return self.reduced(flight, nominal)

    def reduced(self, flight: Linearised, nominal: Nominal) -> Reduced:
        """Return what a flight says, about a vehicle."""
        linear = flight.at(origin(nominal, self.knobs, flight.replay.cut))
        return Pieces(linear).reduced(self._floor)

    def nats(self, reduced: Reduced, true: Rival, other: Rival) -> float:
        """Return what to expect of a true name over another once a flight is flown twice."""
        pairs = Pairs([*self.flown, reduced, reduced], self.knobs)
        a, b = (self._names.index(one.knob.name) for one in (true, other))
        return pairs.pair(a, b).apart(true.value)
