"""The next flight: what is supposed, what is safe, what decides, and what is said of it."""

from dataclasses import replace
import math

from lta_config.course import Course
from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_config.vehicle_edit import set_yaml_values
from lta_discovery.changed_quantities import format_hypothesis
from lta_discovery.flights.measured_flight import FlightStreams, Stream
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.planning.candidate_maneuvers import (
    AltitudeRange,
    build_maneuver,
    list_maneuvers,
)
from lta_discovery.planning.flight_choice import (
    flight_extent,
    list_objections,
    NextFlightPlanner,
    ParameterHypothesis,
    WANTED,
)
from lta_discovery.planning.next_flight import (
    plan_next_flight,
    plan_separating_flight,
    suggest_measurement,
)
from lta_discovery.planning.rehearsal import measure_rehearsal, SimulatedFlight
from lta_flight.flight_spec import load_spec
from lta_model.scenario import load_scenario, Scenario
from lta_model.vehicle import load_vehicle
from lta_sim.readings import FlightOutcome
import numpy as np
import pytest

Known = tuple[NominalVehicle, list[FreeParameter]]
TEXT = find_file('vehicle', 'gtmab').read_text(encoding='utf-8')
SPACE = AltitudeRange(0.5, 2.0)


@pytest.fixture(scope='module')
def planner() -> NextFlightPlanner:
    """Plans for a GT-MAB in a hall, seen by a tracker and all sensors."""
    return NextFlightPlanner(load_spec('gtmab', 'hall', 'bag', ''), TEXT)


@pytest.mark.parametrize(
    ('name', 'value'),
    [('linear_drag.surge', 0.03), ('rotor_fault.lost_3', 0.14), ('cg_offset.x', -0.004),
     ('motor_lag', 0.03), ('command_delay.delay', 0.04), ('net_lift.force', -0.01)],
)  # fmt: skip
def test_a_vehicle_is_what_it_is_supposed_to_be(
    gtmab: Known, tmp_path, name: str, value: float
) -> None:
    knob = next(one for one in gtmab[1] if one.name == name)
    turned = knob.apply_to(gtmab[0], value)
    path = tmp_path / 'supposed.yaml'
    path.write_text(format_hypothesis(TEXT, load_vehicle('gtmab'), turned))
    for (effect, parameter), rate in knob.moves.items():
        before = gtmab[0].parameter_value(effect, parameter)
        found = NominalVehicle.from_vehicle(load_vehicle(str(path))).parameter_value(
            effect, parameter
        )
        assert found == pytest.approx(before + rate * value)


def test_every_manoeuvre_takes_off_stays_between_its_heights_and_lands() -> None:
    for one in list_maneuvers(SPACE):
        course = Course.model_validate(one.course)
        heights = [row.altitude.si for row in course.rows]
        assert heights[-1] == 0.0
        assert SPACE.low <= min(heights[:-1]) <= max(heights) <= SPACE.high
        assert course.rows[-1].at.si < one.length
    costs = [one.cost for one in list_maneuvers(SPACE)]
    assert costs == sorted(costs)
    turns = Course.model_validate(build_maneuver('yaws', SPACE, 20.0, 0.0).course)
    assert {round(row.heading.si, 2) for row in turns.rows} == {1.2, -1.2}


def _rehearsed(**changes: object) -> SimulatedFlight:
    """Return a quiet flight of 2 m that lands."""
    path = np.zeros((100, 3))
    path[:, 0], path[:, 2] = np.linspace(0.0, 2.0, 100), 0.42 + np.hanning(100)
    still = FlightStreams(
        Stream(np.arange(2.0), np.zeros((2, 7))), Stream(np.zeros(1), np.zeros((1, 4)))
    )
    sound = SimulatedFlight(still, FlightOutcome.REACHED, path, np.full((100, 4), 0.3), 0.1, 0.42)
    return replace(sound, **changes)  # type: ignore[arg-type]


def test_what_is_not_safe_is_said() -> None:
    vehicle, hall = load_vehicle('gtmab'), load_scenario('lamp_room')
    assert list_objections(_rehearsed(), vehicle, hall) == []
    x, y, z = flight_extent(_rehearsed(), vehicle)
    assert x - y == pytest.approx(2.0)  # the way, and the hull in every direction
    assert 0.5 * y > z - 1.42 > 0.25  # a hull that is wider than high
    far, high, up = (_rehearsed().path.copy() for _ in range(3))
    far[50, 0], high[50, 2], up[-1, 2] = 4.6, 2.6, 0.9
    duties = np.full((100, 4), 0.3)
    duties[:20, 1] = 1.0
    for wrong, words in (
        (_rehearsed(outcome=FlightOutcome.ESCAPED), 'left the room'),
        (_rehearsed(path=far), 'within 0.3 m of a wall'),
        (_rehearsed(path=high), 'within 0.3 m of the ceiling'),
        (_rehearsed(tilt=math.radians(31.0)), 'tilts by 31 degrees'),
        (_rehearsed(duties=duties), 'a rotor is saturated'),
        (_rehearsed(path=up), 'does not land'),
    ):
        (said,) = list_objections(wrong, vehicle, hall)
        assert words in said


@pytest.mark.long
def test_steps_of_height_tell_a_wind_from_one_that_grows_with_height(
    planner: NextFlightPlanner,
) -> None:
    """Both have one size at one height: only another height tells them apart."""
    wind, grows = (
        planner.find_parameter('steady_wind.x'),
        planner.find_parameter('wind_gradient.x_z'),
    )
    first = ParameterHypothesis(wind, 0.004)
    hover, steps = (
        planner.predict_evidence(
            build_maneuver(name, planner.space, 45.0, 0.0),
            first,
            [ParameterHypothesis(grows, 0.004)],
        )
        for name in ('hover', 'heights')
    )
    assert hover is not None
    assert steps is not None
    assert steps > 2.0 * hover


@pytest.mark.long
def test_the_flight_that_tells_two_drags_apart_changes_its_speed(
    planner: NextFlightPlanner,
) -> None:
    drags = [planner.find_parameter(f'{name}.surge') for name in ('linear_drag', 'quadratic_drag')]
    first, other = (
        ParameterHypothesis(knob, value) for knob, value in zip(drags, (0.02, 0.15), strict=True)
    )
    chosen = planner.choose_flight(first, [other])
    assert chosen is not None
    assert chosen.nats >= WANTED
    speeds = {row['speed']['value'] for row in chosen.manoeuvre.course['rows']}
    assert len(speeds) > 2
    scene = Scenario.model_validate(chosen.flight_spec.contents['scenario'])
    assert scene.course is not None
    assert scene.goal.time_limit.si == chosen.manoeuvre.length


def test_where_nothing_in_flight_decides_it_says_what_to_measure() -> None:
    found = plan_separating_flight('gtmab', 'net_lift.force', 'payload.mass')
    assert found.scenario is None
    assert 'weigh the vehicle' in found.text
    assert (
        'tracker record it'
        in plan_separating_flight('gtmab', 'tracker_delay.delay', 'clock_offset.offset').text
    )
    assert suggest_measurement('linear_drag.surge', ('quadratic_drag.surge',), 'wrench') == (
        'record the motor duties as well'
    )
    assert suggest_measurement('net_lift.force', ('payload.mass',), 'pose').startswith(
        'each acts as a constant'
    )


def test_what_cannot_be_planned_is_refused() -> None:
    with pytest.raises(BadInput, match=r"effect 'net_lift\.foce'"):
        plan_separating_flight('gtmab', 'net_lift.foce', 'payload.mass')
    with pytest.raises(BadInput, match='is given twice'):
        plan_separating_flight('gtmab', 'cg_offset.x', 'cg_offset.x')


def test_what_no_flight_separates_is_said_of_names_of_a_study() -> None:
    names = ('net_lift.force', 'payload.mass', 'ballast.mass')
    plan = plan_next_flight('gtmab', TEXT, names, {'net_lift.force': -0.01}, 'all')
    assert plan.scenario is None
    assert plan.text.startswith('No flight separates net_lift.force, payload.mass and')


def test_a_rehearsed_command_is_what_makes_the_rotor_wrench_by_the_gains_of_the_file(
    tmp_path,
) -> None:
    """Where a third of a command arrives, three times as much is commanded."""
    time = np.arange(0.0, 20.0, 0.04)
    pose = np.tile([0.0, 0.0, 1.5, 0.0, 0.0, 0.0, 1.0], (len(time), 1))
    duties = 0.3 + 0.1 * np.sin(time)[:, None] * np.ones(4)
    streams = FlightStreams(Stream(time, pose), Stream(time, duties))
    gain = {'value': 0.3, 'unit': '1', 'source': 'a calibration'}
    path = tmp_path / 'weak.yaml'
    path.write_text(set_yaml_values(TEXT, {'effects.wrench_gain': {'surge': gain}}))
    whole, weak = (
        measure_rehearsal(streams, vehicle, 'wrench').wrench
        for vehicle in (load_vehicle('gtmab'), load_vehicle(str(path)))
    )
    assert whole is not None
    assert weak is not None
    assert np.abs(whole.values[:, 0]).max() > 1e-3
    np.testing.assert_allclose(0.3 * weak.values[:, 0], whole.values[:, 0])
    np.testing.assert_allclose(weak.values[:, 1:], whole.values[:, 1:])
