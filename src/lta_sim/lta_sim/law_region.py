"""Watch whether a flight leaves the region of the law of its vehicle."""

from typing import Final, final

from lta_config.quantity import format_with_unit
from lta_config.schema.vehicle_law import Law, QUANTITIES, quantity_unit
from lta_model.effects.law import list_law_parameters, list_law_quantities
from lta_model.law_arrays import evaluate_distance
from lta_model.rigid_body import airspeed, build_motion, rotation_matrix
from lta_model.state import RIGID
from lta_sim.simulated_vehicle import LAYOUT, SimulatedVehicle
import numpy as np

# Distance to the range, in half of its width: at less, 97 % of the law and more are left
NOTICED: Final = 0.1


@final
class LawRegion:
    """
    Compare a flight with the region of the law of a vehicle file.

    Attribute `warning`: the first quantity that was clearly out of its range, as a sentence; ''
    until then.
    """

    def __init__(self, name: str, law: Law | None) -> None:
        self.warning = ''
        self._name, self._law = name, law
        self._parameters = tuple(list_law_parameters(law).values()) if law else ()
        first = LAYOUT.remembers['law']
        self._memory = slice(first, first + LAYOUT.memory_size('law'))

    def check_state(self, vehicle: SimulatedVehicle) -> None:
        """Check an evaluated state of the vehicle, unless a warning is there already."""
        law = self._law
        if law is None or self.warning:
            return
        x, y, z, *rest = vehicle.state[:RIGID].tolist()
        r = rotation_matrix(tuple(rest[:4]))
        velocity, rates = tuple(rest[4:7]), tuple(rest[7:])
        motion = build_motion(
            (x, y, z),
            r,
            velocity,
            rates,
            airspeed(r, velocity, tuple(vehicle.wind.tolist())),
            tuple(vehicle.body.tolist()),
            tuple(vehicle.command.tolist()),
            tuple(vehicle.surroundings.tolist()),
        )
        values = list_law_quantities(
            self._parameters,
            tuple(vehicle.state[self._memory].tolist()),
            motion,
            tuple(vehicle.thrusts.tolist()),
        )
        seen = dict(zip(QUANTITIES, values, strict=True))
        distances = evaluate_distance(law, {name: np.array([seen[name]]) for name in law.region})
        for name, distance in distances.items():
            if distance[0] > NOTICED:
                self.warning = self._describe_departure(law, name, seen[name])
                return

    def _describe_departure(self, law: Law, name: str, value: float) -> str:
        """Return the sentence about a quantity out of its range."""
        unit = quantity_unit(name, law.hidden)
        low, high = law.region[name]
        limits = format_with_unit(f'{low:.3g} to {high:.3g}', unit)
        return (
            f'The law of vehicle {self._name} is valid for {name} {limits}, and fades to zero '
            f'outside: here, {name} reached {format_with_unit(f"{value:.3g}", unit)}.'
        )
