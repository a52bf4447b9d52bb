"""
Measure the kernel: one vehicle on one core, many on all, closed loops in a batch, and a GPU.

The vehicle is GT-MAB as its file has it, every other effect at its null values, one number away.
With every effect on (`_all`), those others are a tenth of their prior spread away from null.
"""

from functools import cache, partial
import os
from pathlib import Path
import subprocess
import sys
import tempfile
import time

from lta_config.topics import load_topic_table
from lta_flight.batch.batch_flight import BatchFlight, build_flight
from lta_flight.batch.flight_loop import FIGURES
from lta_flight.batch.fly import Device, fly_many
from lta_flight.flight_spec import build_vehicle_scenario_stack, load_spec
from lta_model.effects import EFFECTS, initial_memory
from lta_model.effects.protocol import Effect
from lta_model.model import VehicleModel
from lta_model.state import pack_state, ROTOR_PLACE, SURROUNDINGS
from lta_model.vehicle import load_vehicle
from lta_sim.kernels.cpu_batch import advance_many
from lta_sim.kernels.kernel import advance
from lta_sim.kernels.vehicle_batch import VehicleBatch
import numpy as np

from campaigns.bench import Figure, measure_pace

STEP = 2e-3
DUTY = np.array([0.145, 0.145, 0.2, 0.2])  # forward, and slowly up
# Wind, noise, sunlight and a cell that is not full: for whatever effect looks at them.
SURROUNDED = np.array([0.1, 0.05, 0.0, 0.3, -0.2, 0.1, 300.0, 3.8, 0.02, 0.01, 0.0])
SHARE = 0.1
HOVER = (0.13, 0.13, 0.0, 0.0)  # of GT-MAB's vertical pair, about
FLIGHTS = 200  # of a batch
MILLION = 1_000_000  # flights on a GPU
MINUTE = round(60.0 / STEP)  # steps

# What a small step from null cannot say: a room that the vehicle fits into, air that knows it.
HULL = {'radius': 0.5, 'half_height': 0.3}
ROOM = {'x_low': -500.0, 'x_high': 500.0, 'y_low': -500.0, 'y_high': 500.0, 'ceiling': 500.0}
GIVEN: dict[str, dict[str, float]] = {
    'walls': ROOM | HULL | {'stiffness': 20.0, 'relaxation': 0.2, 'friction': 0.5},
    'ceiling_effect': {'radius': 0.025, 'height': 100.0},
    'ground_effect': {'radius': 0.025},
    'turbulence': {f'{axis}_length': 5.0 for axis in ('along', 'across', 'up')},
    'wind_profile': {'half_height': HULL['half_height']},
}
FIRST = """
import time; begin = time.perf_counter()
import numpy as np
from lta_model.effects import initial_memory
from lta_sim.kernels.kernel import advance
from lta_model.model import VehicleModel
from lta_model.state import pack_state
weight = {'weight_and_buoyancy': {'gravity': 9.81}}
model = VehicleModel.build(weight, mass=0.358, cg=np.zeros(3), inertia=np.eye(3))
advance(pack_state(memory=initial_memory()), model, (0.1,), (0.1,), 2e-3, 1)
import sys; sys.stdout.write(str(time.perf_counter() - begin))
"""


def nearby(effect: Effect) -> dict[str, float]:
    """Return values of an effect that turn it on and change little."""
    values = {
        one.name: float(np.clip(one.null + SHARE * one.spread, one.low, one.high))
        for one in effect.parameters
    }
    return values | GIVEN.get(effect.name, {})


@cache
def build_vehicle(every: bool = False) -> VehicleModel:
    """Return GT-MAB, with its own effects or with every one."""
    loaded = load_vehicle('gtmab')
    on = loaded.build_model().effect_parameters
    others = {name: nearby(effect) for name, effect in EFFECTS.items() if name not in on}
    return VehicleModel.build(
        loaded.collect_effects() | (others if every else {}),
        mass=loaded.mass,
        cg=loaded.cg,
        inertia=loaded.inertia,
        displaced=loaded.displaced_mass,
        rotors=[(rotor.place, rotor.axis) for rotor in loaded.rotors],
    )


def build_start() -> np.ndarray:
    """Return the state of the vehicle at rest in the air."""
    return pack_state((0.0, 0.0, 1.0), memory=initial_memory())


@cache
def scatter_vehicles(
    count: int, every: bool = False
) -> tuple[np.ndarray, VehicleBatch, np.ndarray, np.ndarray]:
    """Return states, different vehicles, their duties and what surrounds them."""
    generator = np.random.default_rng(1)

    def about(values: np.ndarray, size: int) -> np.ndarray:
        return values * generator.uniform(0.95, 1.05, (count, size))

    model = build_vehicle(every)
    parameters = about(model.parameters, len(model.parameters))
    # Heavier or lighter as a whole, air and inertia with it: the mass matrix stays consistent.
    heavier = generator.uniform(0.95, 1.05, (count, 1))
    body = np.repeat(model.body[np.newaxis], count, axis=0)
    body[:, :ROTOR_PLACE] *= heavier
    fleet = VehicleBatch(
        parameters, np.repeat(model.on[np.newaxis], count, axis=0), body, model.inverse / heavier
    )
    states = np.repeat(build_start()[np.newaxis], count, axis=0)
    states[:, :3] += generator.uniform(-0.3, 0.3, (count, 3))
    states[:, 7:13] = generator.uniform(-0.3, 0.3, (count, 6))
    return states, fleet, about(DUTY, len(DUTY)), about(SURROUNDED, SURROUNDINGS)


def check_flight(states: np.ndarray) -> None:
    """Raise `FloatingPointError` where what was measured is no flight."""
    if not np.isfinite(states).all():
        raise FloatingPointError('the vehicle left the numbers')


def measure_single(every: bool, steps: int, calls: int = 1) -> float:
    """Return the pace of one vehicle, called in a loop inside. [steps/s]"""
    model, state = build_vehicle(every), build_start()
    begin = time.process_time()
    for _ in range(calls):
        last = advance(state, model, DUTY, SURROUNDED, STEP, steps)
    taken = time.process_time() - begin
    check_flight(last)
    return calls * steps / taken


def measure_batch(every: bool, count: int = 10_000, steps: int = 500) -> float:
    """Return the pace of many vehicles together, on all cores. [steps/s]"""
    states, fleet, duties, surroundings = scatter_vehicles(count, every)
    begin = time.process_time()
    last = advance_many(states, fleet, duties, surroundings, STEP, steps)
    reached = measure_pace(count * steps, begin)
    check_flight(last)
    return reached


def measure_first_step(warm: bool) -> float:
    """Return the time of a new process from import to its first step, by its cache. [s]"""
    path = os.pathsep.join(filter(None, sys.path))
    with tempfile.TemporaryDirectory() as cache_folder:
        environment = os.environ | {'PYTHONPATH': path, 'XDG_CACHE_HOME': str(Path(cache_folder))}
        command = [sys.executable, '-c', FIRST]
        times = [
            float(subprocess.check_output(command, env=environment, text=True))
            for _ in range(3 if warm else 1)
        ]
    return min(times)


def list_kernel() -> list[Figure]:
    """Return the figures of the kernel."""
    one, many = 'steps/s', 'vehicle-steps/s'
    return [
        Figure('kernel.single', one, partial(measure_single, False, 300_000),
               "one vehicle on one core, RK4 in double precision, with GT-MAB's effects on"),
        Figure('kernel.single_all', one, partial(measure_single, True, 300_000),
               'one vehicle with every effect on'),
        Figure('kernel.control_step', 'calls/s',
               lambda: measure_single(False, 5, 10_000) / 5, 'calls of 5 steps'),
        Figure('kernel.batched', many, partial(measure_batch, False),
               'many vehicles on all cores; each equals a single run to the last bit'),
        Figure('kernel.batched_all', many, partial(measure_batch, True),
               'the same with every effect on'),
        Figure('kernel.cold', 's', partial(measure_first_step, False),
               'from the first import to the first step with an empty cache', min),
        Figure('kernel.warm', 's', partial(measure_first_step, True),
               'the same with a filled cache', min),
    ]  # fmt: skip


def build_paper_flight(duties: tuple[float, ...] = ()) -> BatchFlight:
    """Return the flight of GT-MAB to the lamp, or one at constant duties."""
    spec = load_spec('gtmab', 'lamp_room', 'bag', 'gtmab')
    return build_flight(*build_vehicle_scenario_stack(spec), load_topic_table(), duties)


def measure_fleet(device: Device, flights: int, duties: tuple[float, ...] = ()) -> float:
    """Return seconds of flight flown in a second, of a whole call."""
    flight, which = build_paper_flight(duties), np.zeros(flights, dtype=np.intp)
    begin = time.perf_counter()
    results = fly_many([flight], range(flights), device, closed=not duties, which=which)
    return float(results[:, FIGURES.index('end')].sum()) / (time.perf_counter() - begin)


def list_fleet() -> list[Figure]:
    """Return the figures of a batch of flights."""
    unit = 'vehicle s/s'
    return [
        Figure('fleet.closed', unit, partial(measure_fleet, 'cpu-batch', FLIGHTS),
               'closed loops in a batch on all cores, with the statistics of the light'),
        Figure('fleet.open', unit, partial(measure_fleet, 'cpu-batch', FLIGHTS, HOVER),
               'the same at constant duties'),
    ]  # fmt: skip


def list_gpu() -> list[Figure]:
    """
    Return the figures of a GPU (requirements-gpu.txt), copying included.

    Raises
    ------
    BadInput
        If there is no GPU that numba-cuda can use.

    """
    from lta_sim.kernels import gpu

    def advance_copies(count: int, steps: int) -> float:
        states, fleet, duties, surroundings = scatter_vehicles(1000)
        rows = np.arange(count) % 1000
        flights = states[rows], fleet.select_vehicles(rows), duties[rows], surroundings[rows]
        begin = time.perf_counter()
        gpu.advance_many(*flights, STEP, steps)
        return time.perf_counter() - begin

    def measure_difference() -> float:
        states, *others = scatter_vehicles(1000)
        risen = states.copy()
        risen[:, 2] += 100.0
        there = gpu.advance_many(risen, *others, STEP, MINUTE)
        return float(np.max(abs(there - advance_many(risen, *others, STEP, MINUTE))))

    advance_copies(1, 1)
    return [
        Figure('gpu.batched', 'vehicle-steps/s',
               lambda: MILLION * MINUTE / advance_copies(MILLION, MINUTE),
               'a million flights of 60 s'),
        Figure('gpu.closed', 'vehicle s/s', partial(measure_fleet, 'gpu', MILLION),
               'closed loops on a GPU'),
        Figure('gpu.difference', 'SI', measure_difference,
               "largest deviation of 1000 states from the CPU's after 60 s in the air"),
    ]  # fmt: skip
