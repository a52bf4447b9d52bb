# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Demonstrate discovery: hide an effect, fly with it, and find it.

The controller uses the vehicle file, without the hidden effect. A dither on its commands makes the
rotors distinguishable. The bag holds what a real flight would record, with a noisy tracker, and no
trace of the effect. The truth is known here: two fits of the tolerances, without the effect and
with its true value, show whether forecasts of the held-out flight need it; if not, another effect
is drawn.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
import shutil
from typing import Any, Final, final, NamedTuple

from lta_bag.provenance import collect_provenance
from lta_bag.writer import BagWriter
from lta_config.errors import BadInput, unknown_name_error
from lta_config.files import find_file
from lta_config.topics import load_topic_table
from lta_control.motion import Setpoint
from lta_discovery.changed_quantities import format_hypothesis
from lta_discovery.discovery.forecast_comparison import compare_forecasts, ComparedModel
from lta_discovery.discovery.run import discover_effects, DiscoveryRequest, Tell
from lta_discovery.discovery.study import NAMED, TUNED
from lta_discovery.flights.bags import read_bags, Role
from lta_discovery.flights.measured_flight import MeasuredFlight
from lta_discovery.flights.usable_flights import select_usable_flights
from lta_discovery.lab_tests.rehearsal import POSE_NOISE, TURN_NOISE
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import apply_parameters, FreeParameter, list_free_parameters
from lta_discovery.posterior.missing_elements import LEARNING, LINEARIZATIONS
from lta_discovery.state_filter.forecast_noise import HORIZONS
from lta_discovery.state_filter.forecast_scores import FILE_MODEL
from lta_discovery.state_filter.linear_flight import FlightSystem
from lta_discovery.state_filter.noise_model import NoiseModel
from lta_discovery.state_filter.parameter_fit import fit_likelihood
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_run import SIMULATED_ROBOT
from lta_flight.flight_spec import build_vehicle_scenario_stack, FlightSpec, load_spec
from lta_model.vehicle import load_vehicle, Vehicle
from lta_report.report import Report
from lta_sim.world import World
import numpy as np
from scipy.spatial.transform import Rotation
import yaml

SECONDS: Final = 48.0  # of each flight
FLIGHTS: Final[tuple[tuple[str, Role], ...]] = (
    ('A', 'train'), ('B', 'confirm'), ('C', 'holdout'),
)  # fmt: skip
DEMO_SPACING: Final = 1000  # between the seeds of two demonstrations, so that their flights differ
DEMO_DRAWS: Final = 12  # most effects that are drawn; each takes a quarter of the time of a study
# Times the error with the effect: below these, a demonstration shows little
LEAST_BEFORE: Final = 5.0  # error of the vehicle file
LEAST_TUNED: Final = 2.0  # error with its tolerances fitted; below it, they pass for the effect
HIDDEN_VEHICLE: Final = 'gtmab'
SCENARIO: Final = 'lamp_room'
HIDDEN_FLIGHT_STRATEGY: Final = 'bag'
DITHER_START: Final = 4.0  # s; start of the dither
DITHER: Final = 0.15  # duty, either way; with more, vehicles without reversible rotors would climb
EACH: Final = (0.4, 1.2)  # s; shortest and longest dither step
LEG: Final = 8.0  # s; duration of a setpoint
# A large hall, so that walls have no influence.
HALL: Final = {
    'scenario.room.size': {'value': [60.0, 60.0, 12.0], 'unit': 'm'},
    'scenario.start.position': {'value': [0.0, 0.0], 'unit': 'm'},
}


# Smallest and largest value of each number that the demonstration hides. Others, such as an offset
# centre of gravity or a weak rotor, pass for fitted tolerances of the vehicle file in its flights.
HIDEABLE: Final[dict[str, tuple[float, float]]] = {
    'wind_gradient.x_y': (0.02, 0.06),
    'wind_gradient.y_x': (0.02, 0.06),
    'linear_drag.sway': (0.04, 0.08),
    'linear_drag.surge': (0.05, 0.1),
}


@final
@dataclass(frozen=True, slots=True)
class DemoEffect:
    """The hidden effect."""

    name: str  # of the parameter: 'linear_drag.surge', 'motor_lag'
    value: float  # in `unit`
    unit: str  # SI

    def hide_in(self, spec: FlightSpec) -> FlightSpec:
        """Return a flight whose vehicle has the effect."""
        vehicle = build_vehicle_scenario_stack(spec)[0]
        nominal = NominalVehicle.from_vehicle(vehicle)
        parameter = find_free_parameter(self.name)
        changed = parameter.apply_to(nominal, self.value - find_present_value(parameter, nominal))
        text = find_file('vehicle', spec.names['vehicle']).read_text(encoding='utf-8')
        content: Any = yaml.safe_load(format_hypothesis(text, vehicle, changed))
        return replace(spec, contents={**spec.contents, 'vehicle': content})

    def __str__(self) -> str:
        """Return the effect as readable text."""
        unit = '' if self.unit == '1' else f' {self.unit}'
        return f'{self.name} = {self.value:.4g}{unit}'


def draw_demo_effects(seed: int) -> Iterator[DemoEffect]:
    """Yield the effects that a seed draws to be hidden, without end."""
    rng = np.random.default_rng([seed, 5])
    while True:
        name = tuple(HIDEABLE)[int(rng.integers(len(HIDEABLE)))]
        value = float(rng.uniform(*HIDEABLE[name]))
        yield DemoEffect(name, value, find_free_parameter(name).unit)


@cache
def list_candidates() -> dict[str, FreeParameter]:
    """Return the parameters that discovery looks for in the vehicle of the demonstration."""
    nominal = NominalVehicle.from_vehicle(load_vehicle(HIDDEN_VEHICLE))
    return {each.name: each for each in list_free_parameters(nominal) if each.typical > 0.0}


def find_free_parameter(name: str) -> FreeParameter:
    """Return a candidate by name; raise `BadInput` with the known names."""
    candidates = list_candidates()
    if name not in candidates:
        raise unknown_name_error('parameter of an effect', name, list(candidates))
    return candidates[name]


def find_present_value(parameter: FreeParameter, nominal: NominalVehicle) -> float:
    """Return the value from which a parameter moves: that of the file, or of an absent effect."""
    begun = parameter.enable_effect(nominal)
    return begun.parameter_value(*next(iter(parameter.moves)))


def build_demo_course(seed: int) -> Callable[[float], Setpoint]:
    """Return setpoints by time: a new height, heading and speed every few seconds."""
    rng = np.random.default_rng([seed, 7])
    heading, legs = 0.0, []
    # Longer than any flight; `LEG` seconds each
    for _ in range(256):
        heading += float(rng.uniform(-2.0, 2.0))
        speed = float(rng.choice([0.0, 0.3, 0.6]))
        legs.append(Setpoint(float(rng.uniform(1.0, 2.0)), heading, speed))
    return lambda time: legs[int(time // LEG) % len(legs)]


def fly_hidden(hidden: DemoEffect, seed: int, seconds: float, folder: Path) -> Path:
    """Simulate and record one flight; return its bag."""
    # Imported here, so that the study of recorded flights does not need ROS.
    from lta_flight.messages import LoopRecorder

    made_of = load_spec(HIDDEN_VEHICLE, SCENARIO, HIDDEN_FLIGHT_STRATEGY, '').with_values(HALL)
    vehicle, scenario, policy = build_vehicle_scenario_stack(hidden.hide_in(made_of))
    # The controller's vehicle: without the hidden effect
    nominal_vehicle, table = (
        Vehicle(build_vehicle_scenario_stack(made_of)[0].file),
        load_topic_table(),
    )
    world = World(vehicle, scenario, table, seed)
    loop = ClosedLoop(
        world, table, replace(policy, course=build_demo_course(seed)), nominal_vehicle
    )
    provenance = collect_provenance(
        HIDDEN_VEHICLE,
        SCENARIO,
        HIDDEN_VEHICLE,
        seed=str(seed),
        data='simulated',
        about='something is hidden',
    )
    rng = np.random.default_rng([seed, 9])
    dither, until = np.zeros(len(loop.duties)), DITHER_START
    with BagWriter(folder, provenance) as writer:
        recorder = LoopRecorder(writer, loop, table, SIMULATED_ROBOT)
        for _ in loop.iterate_until(lambda: world.elapsed >= seconds):
            if world.elapsed >= until:
                until = world.elapsed + rng.uniform(*EACH)
                dither = rng.uniform(-DITHER, DITHER, len(dither))
            # Rotors that are not reversible reject negative duties
            lows = [-1.0 if both else 0.0 for both in vehicle.reversible]
            loop.duties = tuple(np.clip(np.array(loop.duties) + dither, lows, 1.0).tolist())
            if loop.readings.truth is not None:
                loop.readings = replace(
                    loop.readings, truth=add_tracker_noise(loop.readings.truth, rng)
                )
            recorder.record_step()
    return folder


def add_tracker_noise(truth: tuple[float, ...], rng: np.random.Generator) -> tuple[float, ...]:
    """Return a pose with tracker noise, and NaN for the velocities."""
    place = np.array(truth[:3]) + POSE_NOISE * rng.standard_normal(3)
    turn = Rotation.from_quat(truth[3:7])
    turn *= Rotation.from_rotvec(TURN_NOISE * rng.standard_normal(3))
    # A tracker of passive markers measures no velocities
    return (*place.tolist(), *turn.as_quat().tolist(), *(float('nan'),) * 6)


@final
class ForecastGain(NamedTuple):
    """Position errors of the held-out flight, 3 s ahead [m]."""

    before: float  # with the vehicle file
    tuned: float  # with its tolerances fitted
    after: float  # with the hidden effect, and the tolerances fitted

    @property
    def is_clear(self) -> bool:
        """Whether forecasts need the effect."""
        return self.before >= LEAST_BEFORE * self.after and self.tuned >= LEAST_TUNED * self.after


def measure_forecast_gain(hidden: DemoEffect, bags: Mapping[Role, Sequence[Path]]) -> ForecastGain:
    """Return how well the held-out flight is forecast without the hidden effect and with it."""
    vehicle = load_vehicle(HIDDEN_VEHICLE)
    nominal = NominalVehicle.from_vehicle(vehicle)
    parameter = find_free_parameter(hidden.name)
    changed = parameter.apply_to(nominal, hidden.value - find_present_value(parameter, nominal))
    flights = select_usable_flights(read_bags(bags), vehicle).flights
    used = [flight for _, role, flight in flights if role != 'holdout']
    guess = [NoiseModel.guess(nominal, one) for one in used]
    models = [
        ComparedModel(FILE_MODEL, nominal, guess),
        _fit_tolerances(TUNED, vehicle, nominal, used, guess),
        _fit_tolerances(NAMED, vehicle, changed, used, guess),
    ]
    held_out = {name: flight for name, role, flight in flights if role == 'holdout'}
    main = compare_forecasts(
        vehicle, used, held_out, models, list_free_parameters(nominal), HORIZONS
    ).main
    if main is None:
        return ForecastGain(0.0, 0.0, np.inf)
    return ForecastGain(*(main.errors[name].position for name in (FILE_MODEL, TUNED, NAMED)))


def _fit_tolerances(
    name: str,
    vehicle: Vehicle,
    nominal: NominalVehicle,
    flights: Sequence[MeasuredFlight],
    noise: Sequence[NoiseModel],
) -> ComparedModel:
    """Return a vehicle with its tolerances fitted to some flights."""
    parameters = [one for one in list_free_parameters(nominal) if one.tolerance > 0.0]
    systems = [FlightSystem(vehicle, one, parameters) for one in flights]
    fit = fit_likelihood(
        systems, nominal, np.zeros(len(parameters)), noise, LINEARIZATIONS, LEARNING, is_near=True
    )
    shared = np.where([one.per_flight for one in parameters], 0.0, fit.values)
    return ComparedModel(name, apply_parameters(nominal, parameters, shared)[0], fit.noise)


def run_discovery_demo(seed: int, folder: Path, tell: Tell) -> Report:
    """
    Hide an effect that forecasts need, fly three flights with it, and search for it.

    `seed`: of the effect and the flights. `folder`: empty; the flights go into `flights`. Raise
    `BadInput` if forecasts need none of the effects that the seed draws.
    """
    with _remove_if_aborted(folder):
        hidden, bags = draw_clear_effect(seed, folder, tell)
        report = discover_effects(DiscoveryRequest.of_bags(HIDDEN_VEHICLE, bags), tell)
    assert isinstance(report.data, dict)
    truth = {'name': hidden.name, 'value': hidden.value, 'unit': hidden.unit}
    return replace(
        report,
        facts={**report.facts, 'hidden': str(hidden)},
        data={**report.data, 'hidden': truth},
        closing=(*report.closing, f'Hidden: {hidden}.'),
    )


def draw_clear_effect(
    seed: int, folder: Path, tell: Tell
) -> tuple[DemoEffect, Mapping[Role, Sequence[Path]]]:
    """Return the first effect that forecasts of its held-out flight need, and its flights."""
    effects = draw_demo_effects(seed)
    for count in range(1, DEMO_DRAWS + 1):
        hidden = next(effects)
        bags = fly_all(hidden, seed, folder, tell)
        tell('checking that forecasts need the hidden effect', None)
        if measure_forecast_gain(hidden, bags).is_clear:
            return hidden, bags
        tell(f'forecasts do not need effect {count}: drawing another', None)
        shutil.rmtree(folder / 'flights')
    raise BadInput(
        f'Forecasts need none of the {DEMO_DRAWS} effects that seed {seed} draws; choose another '
        '--seed.'
    )


def fly_all(
    hidden: DemoEffect, seed: int, folder: Path, tell: Tell
) -> Mapping[Role, Sequence[Path]]:
    """Simulate the flights of a demonstration; return the bags by role."""
    bags: dict[Role, Sequence[Path]] = {}
    for k, (name, role) in enumerate(FLIGHTS):
        tell(f'simulating flight {name} with the hidden effect', None)
        # Each flight has its own seed
        place = folder / 'flights' / name
        bags[role] = [fly_hidden(hidden, DEMO_SPACING * seed + k, SECONDS, place)]
    return bags


@contextmanager
def _remove_if_aborted(folder: Path) -> Iterator[None]:
    """Remove the flights of an aborted demonstration."""
    try:
        yield
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
