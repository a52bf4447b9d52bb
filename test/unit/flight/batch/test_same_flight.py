# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
With the loop's random numbers and its ADC samples, the batch's step flies the loop's flight.

A batch draws its noise from counters and models what a light block reads, so it agrees with the
loop in distribution only (`test_fleet.py`). Here each of its draws is one of the loop's streams,
and each of its light blocks is sampled and demodulated: then seed by seed, both fly the same.
"""

from dataclasses import astuple, replace
import math
from types import SimpleNamespace
from typing import NamedTuple

from lta_config.topics import load_topic_table
from lta_control.allocation import NO_ROTORS, pad_to_slots
from lta_control.flight_step import DroneMemory
from lta_control.laws.cascade import CASCADE_LAW
from lta_control.mission import Phase
from lta_flight.batch import control_period, flight_loop
from lta_flight.batch.batch_flight import BatchFlight, build_flight, build_schedule
from lta_flight.batch.control_period import begin_flight, FlightInputs, FlightKernel, WorkArrays
from lta_flight.batch.flight import build_command
from lta_flight.batch.flight_loop import FIGURES
from lta_flight.batch.targets import BatchSchedule, SCRATCH
from lta_flight.flight_spec import build_loop, build_vehicle_scenario_stack, load_spec
from lta_flight.loop_view import LoopView
from lta_flight.report.results import compute_results
from lta_model.electrical.mppt_charger import resting_flow
from lta_model.state import NOISE
from lta_sim import compiled_sensors
from lta_sim.compiled_sensors import ImuAxes, SensorErrors
from lta_sim.simulated_vehicle import SimulatedVehicle
from lta_sim.termination import REACHED
from lta_vlc.lamp import RAYLEIGH_SHARE
from lta_vlc.receiver import BeaconReceiver
import numpy as np
import pytest

TABLE = load_topic_table()
PERIOD, SHAPE = TABLE.control_ns * 1e-9, (TABLE.light.sample_rate.si, TABLE.light.samples)
SCALARS = {compiled_sensors.RANGE: 'range', compiled_sensors.PRESSURE: 'pressure'}
# Name of the stream, and numbers of a sample
TRIPLES = {compiled_sensors.IMU: ('imu', 6), compiled_sensors.TURBULENCE: ('turbulence', 3)}


class LoopNoise:
    """The random numbers and the light of a loop's world, for the step of a batch."""

    def __init__(self, world, policy):
        self.world, self._chance = world, world._chance
        self._beacons = [lamp.wave.frequency for lamp in world.scenario.light_field.lamps]
        self._numbers = {}  # of the newest sample of IMU and turbulence
        self._listener = BeaconReceiver(
            policy.demodulation, *SHAPE, world.vehicle.file.sensors.diodes.largest_reading
        )
        self.errors = SensorErrors(
            ImuAxes(*astuple(world.imu_errors)),
            world._range.offset,
            world._pressure.offset,
            world._pressure.drift,
        )
        # Drawn when the world was built
        self._first = world._around.numbers[NOISE : NOISE + 3] * math.sqrt(PERIOD)

    def draw_normals(self, seed, stream, step, lane):
        if stream in SCALARS:
            return float(self._chance[SCALARS[stream]].standard_normal()), 0.0
        name, count = TRIPLES[stream]
        if lane == 0:
            first = stream == compiled_sensors.TURBULENCE and step == 0
            numbers = self._first if first else self._chance[name].standard_normal(count)
            self._numbers[stream] = (*numbers.tolist(), 0.0)
        return self._numbers[stream][2 * lane : 2 * lane + 2]

    def read_diodes(self, link, lamp, lights, before, seed, step):
        """Return amplitude, SNR and deviation of each diode from the samples of a block."""
        begun = TABLE.start_ns + step * TABLE.control_ns - TABLE['photodiodes'].latency_ns
        block = self.world._light.sample_light_block(begun, *SHAPE, self._chance['photodiodes'])
        if len(self._beacons) > 1:
            self._listener.prioritize_beacon(self._beacons[lamp])
        peaks = self._listener.demodulate_next_block(block).peaks[0]
        errors = np.where(peaks.snr > 0.0, RAYLEIGH_SHARE * peaks.noise, math.inf)
        return tuple(tuple(each.tolist()) for each in (peaks.amplitude, peaks.snr, errors))


def build_kernel(model, noise):
    """Return the kernel that integrates as `World` does, with all effects."""
    craft, begin = SimulatedVehicle(model), tuple(noise.world.state.tolist())

    def evaluate(state, command, surroundings):
        craft.state[:], craft.command[:], craft.surroundings[:] = state, command, surroundings
        craft.evaluate_state()

    def rates(state, numbers, command, surroundings):
        evaluate(state, command, surroundings)
        return tuple(craft.rate.tolist())

    def thrusts_of(state, numbers, command, surroundings):
        evaluate(state, command, surroundings)
        noise.world._light.record_pose(state[:7])  # at the end of each period
        return pad_to_slots(craft.thrusts.tolist())

    def ahead(state, rate, dt):
        return tuple(a + dt * b for a, b in zip(state, rate, strict=True))

    def mean(a, b, c, d):
        both = zip(a, b, c, d, strict=True)
        return tuple((p + 2.0 * (q + r) + s) / 6.0 for p, q, r, s in both)

    def normalised(state):
        length = math.hypot(*state[3:7])
        return (*state[:3], *(part / length for part in state[3:7]), *state[7:])

    dark, own, on = (0.0,) * 8, DroneMemory(), model.effect_parameters
    return FlightKernel(
        dark, own, 'turbulence' in on, 'superheat' in on, rates, thrusts_of,
        ahead, mean, normalised, lambda *_: begin, noise.read_diodes, lambda _: dark,
    )  # fmt: skip


class Prepared(NamedTuple):
    """A batch flight by the noise of a loop: arguments of the step, and its start."""

    kernel: FlightKernel
    schedule: BatchSchedule
    flight: BatchFlight
    inputs: FlightInputs
    work: WorkArrays


def prepare(spec, seed, monkeypatch):
    stack = build_vehicle_scenario_stack(spec)
    flight, world = build_flight(*stack, TABLE), build_loop(spec, seed).world
    noise = LoopNoise(world, stack[2])
    monkeypatch.setattr(compiled_sensors, 'draw_normals', noise.draw_normals)
    monkeypatch.setattr(flight_loop, 'draw_errors', lambda *_: noise.errors)
    # All light is in the samples
    monkeypatch.setattr(control_period, 'write_reflections', lambda *_: None)
    monkeypatch.setattr(control_period, 'add_direct_light', lambda *_: None)
    work = WorkArrays(np.zeros(SCRATCH), np.zeros((8, 8)), np.zeros((8, 8)), np.zeros(1))
    inputs = FlightInputs(np.zeros(1), flight.recorded, noise.errors, seed, 0.0)
    kernel = build_kernel(flight.model, noise)
    return Prepared(kernel, build_schedule(TABLE), flight, inputs, work)


def iterate_memories(made):
    """Yield the memory after each control period."""
    kernel, constants = made.kernel, made.flight.craft
    state = kernel.add_effects((), 0)
    distance = compiled_sensors.simulate_range_reading(
        constants.sensors, made.inputs.errors, 0, 0, state
    )
    memory = begin_flight(
        made.flight.strategy, kernel.begin, state, build_command(constants, NO_ROTORS),
        kernel.dark, resting_flow(constants.power.charge), distance,
    )  # fmt: skip
    while True:
        memory = control_period.simulate_period(
            kernel, made.schedule, made.flight.strategy, CASCADE_LAW, constants, memory,
            made.inputs, made.work,
        )  # fmt: skip
        yield memory


def long(*case):
    return pytest.param(*case, marks=pytest.mark.long)


def build_spec(strategy, scene, folder=None):
    """Return a flight that begins soon."""
    changes = {'estimator.rest_time': 0.15, 'mission.altitude': 0.5}
    if scene == 'windy_field':  # in 8 m/s GT-MAB rises instead
        changes['scenario.air.profile.wind'] = '4 m/s'
    scene, _, added = scene.partition(' with ')
    spec = load_spec('gtmab', scene, strategy, 'gtmab').with_values(changes)
    return SCENES[added](spec, folder) if added else spec


def add_recorded_wind(spec, folder):
    time = np.arange(0.0, 70.0, 0.7)
    wind = 0.2 * np.array([np.cos(0.8 * time), np.sin(0.8 * time), np.sin(2.4 * time)])
    path = folder / 'wind.csv'
    np.savetxt(path, np.vstack([time, wind]).T, delimiter=',', header='t,u,v,w', comments='')
    return change_scenario(spec, lambda scene: {'air': {**scene['air'], 'recorded': str(path)}})


def add_faults(spec, folder):
    """Short the panel, and let the supply fail so late that the mission does not know yet."""
    del folder
    lit = spec.with_values({'scenario.ambient.steady': '1000 lx'})
    return change_scenario(
        lit, lambda scene: {'faults': {'panel_short': '2 s', 'brown_out': '4.9 s'}}
    )


def change_scenario(spec, change):
    scene = spec.contents['scenario']
    return replace(spec, contents={**spec.contents, 'scenario': {**scene, **change(scene)}})


SCENES = {'a recorded wind': add_recorded_wind, 'faults': add_faults}


@pytest.mark.parametrize(
    ('strategy', 'scene'),
    [
        ('dga', 'lamp_room'),
        ('homing', 'warehouse'),  # a route along three lamps
        ('homing', 'windy_field'),  # held by a hand at first, in gusts
        ('homing', 'hall_door'),  # daylight and wind beyond a door
        ('bag', 'lamp_room with a recorded wind'),
        ('bag', 'lamp_room with faults'),  # of the supply
        long('bag', 'lamp_room'),
        long('des', 'lamp_room'),
        long('homing', 'sunny_field'),  # warm gas, and a charging panel
        long('homing', 'gusty_hall'),
    ],
)
def test_with_the_loops_noise_the_step_flies_the_loops_flight(
    strategy, scene, monkeypatch, tmp_path
):
    """Five seconds, of which the search takes more than half of one at least."""
    spec = build_spec(strategy, scene, tmp_path)
    loop, flown = build_loop(spec, 3), iterate_memories(prepare(spec, 3, monkeypatch))
    state, charge = loop.world.state.tolist(), loop.world.charge
    for k, (_, memory) in enumerate(zip(loop.iterate_steps(), flown, strict=False)):
        # Messages round ranges and amplitudes to single precision
        np.testing.assert_allclose(loop.world.state, state, rtol=0.0, atol=1e-6)
        assert loop.world.charge == pytest.approx(charge, rel=1e-8)
        assert loop.duties == pytest.approx(memory.onboard.pilot.law.command.duties[:4], abs=1e-6)
        assert loop.mission.phase == memory.mission.phase
        if loop.next_setpoint is not None:
            assert loop.next_setpoint == pytest.approx(memory.setpoint, abs=1e-6)
        if k == 500:
            break
        state, charge = memory.state, memory.supply.flow.charge
    assert loop.mission.phase is Phase.SEEK
    assert np.hypot(*(loop.world.state[:2] - loop.world.start_pose[:2])) > 0.01


@pytest.mark.long
def test_its_tally_has_the_results_of_the_loop(monkeypatch):
    spec = build_spec('homing', 'lamp_room')
    loop, made = build_loop(spec, 3), prepare(spec, 3, monkeypatch)
    view = LoopView(loop)
    for _ in loop.iterate_steps():
        view.record_step()
    row = flight_loop.fly(
        made.kernel, made.schedule, made.flight.strategy, CASCADE_LAW, made.flight.craft,
        made.inputs.numbers, made.inputs.recorded, 3, made.work,
    )  # fmt: skip
    tally, results = SimpleNamespace(**dict(zip(FIGURES, row, strict=True))), compute_results(view)
    assert tally.outcome == REACHED
    assert results.success
    assert results.end == pytest.approx(tally.end, abs=0.011)
    # The truth is sampled every second period, the battery is metered with noise
    assert results.lift_off == pytest.approx(tally.lift_off, abs=0.021)
    assert results.search_start == pytest.approx(tally.search_start, abs=1e-9)
    assert results.path_length == pytest.approx(tally.path_length, rel=5e-3)
    assert results.closest_horizontal == pytest.approx(tally.closest, abs=0.02)
    assert results.energy == pytest.approx(tally.energy, rel=0.03)
    assert results.lamp_share == pytest.approx(tally.bearings / tally.blocks, abs=1e-9)
    assert results.lamp_error == pytest.approx((tally.squares / tally.bearings) ** 0.5, rel=0.01)
