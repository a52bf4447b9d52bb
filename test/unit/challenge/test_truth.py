"""The truth of a challenge and the project's own model, written apart, fly the same flight."""

from dataclasses import replace

from lta_challenge.truth_flight import PilotInputs
from lta_challenge.truth_simulation import simulate_flight
from lta_challenge.truth_vehicle import build_truth_vehicle
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, list_free_parameters
from lta_model.effects import initial_memory
from lta_model.state import pack_state, SURROUNDINGS, VOLTAGE
from lta_model.vehicle import load_vehicle
from lta_sim.kernels.kernel import advance
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
TICKS = 1000  # of 10 ms
GTMAB = NominalVehicle.from_vehicle(load_vehicle('gtmab'))
TURNED = {knob.name: knob for knob in list_free_parameters(GTMAB) if knob.typical}
MOVING = [
    name
    for name, knob in TURNED.items()
    if knob.reaches not in ('reading', 'delay') and not name.startswith('superheat')
]


def pilot(ticks: int = TICKS, seed: int = 5) -> PilotInputs:
    """Climb, turn and go ahead, shaken."""
    rng = np.random.default_rng(seed)
    time = 0.01 * np.arange(ticks)
    wanted = np.column_stack([1.0 + 0.1 * time, 0.3 * time, np.full(ticks, 0.4)])
    shaken = np.zeros((ticks, 8))
    shaken[:, :4] = rng.uniform(-0.15, 0.15, (ticks // 50 + 1, 4))[(time // 0.5).astype(int)]
    return PilotInputs(wanted, np.zeros((ticks, 3)), shaken)


def flown_by_model(
    nominal: NominalVehicle, commands: Array, voltage: Array, height: float
) -> Array:
    """Return the states of the project's own model under the same commands."""
    grounded = {k: v for k, v in nominal.effect_parameters.items() if k != 'floor_contact'}
    model = replace(nominal, effect_parameters=grounded).build_model()
    state = pack_state((0.0, 0.0, height), memory=initial_memory())
    around, out = np.zeros(SURROUNDINGS), []
    for command, volts in zip(commands, voltage, strict=True):
        out.append(state[:13])
        around[VOLTAGE] = volts
        state = advance(state, model, command, around, 0.002, 5)
    return np.array(out)


def apart(nominal: NominalVehicle, late: int = 0) -> tuple[float, float, float]:
    """Return by how much place [m], attitude [rad] and speed [m/s] of the two differ at most."""
    flight = simulate_flight(build_truth_vehicle(nominal), pilot(), GTMAB)
    obeyed = np.zeros_like(flight.commands)
    obeyed[late:] = flight.commands[: len(obeyed) - late]
    states = flown_by_model(nominal, obeyed, flight.voltage, 1.5)
    there = Rotation.from_quat(states[:, 3:7])
    turn = (there.inv() * Rotation.from_matrix(flight.rotation)).magnitude()
    return (
        float(np.abs(states[:, :3] - flight.position).max()),
        float(turn.max()),
        float(np.abs(states[:, 7:10] - flight.velocity).max()),
    )


def hidden(knob: FreeParameter) -> NominalVehicle:
    """Return the GT-MAB with a knob turned by three times its typical size, or what it may."""
    return knob.apply_to(GTMAB, min(max(3.0 * knob.typical, 0.5 * knob.low), 0.5 * knob.high))


def test_the_plain_vehicle_flies_alike() -> None:
    assert max(apart(GTMAB)) < 1e-6


@pytest.mark.parametrize('name', MOVING)
def test_each_effect_flies_alike_and_matters(name: str) -> None:
    knob = TURNED[name]
    most = min(3.0 * knob.typical, knob.high)
    nominal = knob.apply_to(GTMAB, most) if knob.high > 0.0 else hidden(knob)
    place, turn, speed = apart(nominal)
    # A tilted rotor turns exactly here and to first order there: 0.027 rad squared.
    rough = 40.0 if name.startswith('rotor_misalignment') else 1.0
    assert max(place, turn, speed) < 1e-4 * rough


def test_a_delay_is_a_shift_of_the_commands() -> None:
    nominal = GTMAB.with_value('command_delay', 'delay', 0.03)
    assert max(apart(nominal, late=3)) < 1e-6
