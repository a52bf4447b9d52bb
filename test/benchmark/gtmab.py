"""
The vehicle that the kernel is measured with: GT-MAB as its file has it, or with every effect on.

Its file holds GT-MAB's realistic set; every other effect is at its null values, one number away.
With every effect on, those others are a tenth of their prior spread away from null.
"""

from functools import cache

from lta_model.effects import EFFECTS, initial_memory
from lta_model.effects.protocol import Effect
from lta_model.model import VehicleModel
from lta_model.state import pack_state, ROTOR_PLACE, SURROUNDINGS
from lta_model.vehicle import load_vehicle
from lta_sim.kernels.vehicle_batch import VehicleBatch
import numpy as np

STEP = 2e-3
DUTY = np.array([0.145, 0.145, 0.2, 0.2])  # forward, and slowly up
# Wind, noise, sunlight and a cell that is not full: for whatever effect looks at them.
SURROUNDED = np.array([0.1, 0.05, 0.0, 0.3, -0.2, 0.1, 300.0, 3.8, 0.02, 0.01, 0.0])
SHARE = 0.1

# What a small step from null cannot say: a room that the vehicle fits into, air that knows it.
HULL = {'radius': 0.5, 'half_height': 0.3}
ROOM = {'x_low': -500.0, 'x_high': 500.0, 'y_low': -500.0, 'y_high': 500.0, 'ceiling': 500.0}
LENGTHS = {f'{axis}_length': 5.0 for axis in ('along', 'across', 'up')}
GIVEN: dict[str, dict[str, float]] = {
    'walls': ROOM | HULL | {'stiffness': 20.0, 'relaxation': 0.2, 'friction': 0.5},
    'ceiling_effect': {'radius': 0.025, 'height': 100.0},
    'ground_effect': {'radius': 0.025},
    'turbulence': LENGTHS,
    'wind_profile': {'half_height': HULL['half_height']},
}


def nearby(effect: Effect) -> dict[str, float]:
    """Return values of an effect that turn it on and change little."""
    values = {
        known.name: float(np.clip(known.null + SHARE * known.spread, known.low, known.high))
        for known in effect.parameters
    }
    return values | GIVEN.get(effect.name, {})


@cache
def numbers(every: bool) -> dict[str, dict[str, float]]:
    """Return the parameters of the effects that are on."""
    vehicle = load_vehicle('gtmab')
    own, on = vehicle.collect_effects(), vehicle.build_model().effect_parameters
    others = {name: nearby(effect) for name, effect in EFFECTS.items() if name not in on}
    return own | others if every else own


@cache
def vehicle(every: bool = False) -> VehicleModel:
    """Return GT-MAB, with its own effects or with every one."""
    loaded = load_vehicle('gtmab')
    return VehicleModel.build(
        numbers(every),
        mass=loaded.mass,
        cg=loaded.cg,
        inertia=loaded.inertia,
        displaced=loaded.displaced_mass,
        rotors=[(rotor.place, rotor.axis) for rotor in loaded.rotors],
    )


def start() -> np.ndarray:
    """Return the vehicle at rest in the air."""
    return pack_state((0.0, 0.0, 1.0), memory=initial_memory())


@cache
def scattered(
    count: int, every: bool = False
) -> tuple[np.ndarray, VehicleBatch, np.ndarray, np.ndarray]:
    """Return states, different vehicles, their duties and what surrounds them."""
    generator = np.random.default_rng(1)

    def about(values: np.ndarray, size: int) -> np.ndarray:
        return values * generator.uniform(0.95, 1.05, (count, size))

    model = vehicle(every)
    parameters = about(model.parameters, len(model.parameters))
    # Heavier or lighter as a whole, air and inertia with it: the mass matrix stays consistent.
    heavier = generator.uniform(0.95, 1.05, (count, 1))
    body = np.repeat(model.body[np.newaxis], count, axis=0)
    body[:, :ROTOR_PLACE] *= heavier
    fleet = VehicleBatch(
        parameters, np.repeat(model.on[np.newaxis], count, axis=0), body, model.inverse / heavier
    )
    states = np.repeat(start()[np.newaxis], count, axis=0)
    states[:, :3] += generator.uniform(-0.3, 0.3, (count, 3))
    states[:, 7:13] = generator.uniform(-0.3, 0.3, (count, 6))
    return states, fleet, about(DUTY, len(DUTY)), about(SURROUNDED, SURROUNDINGS)
