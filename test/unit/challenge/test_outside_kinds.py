"""Kinds that were written late push as a hand reckons, and come to what was asked for."""

from collections.abc import Callable, Sequence
import math

from lta_challenge.case import CaseGenerator, wrench_strength
from lta_challenge.course import plan_pilot_inputs
from lta_challenge.effect_injection import (
    choose_outside_kind,
    draw_outside_parameters,
    FAINT,
    scale_unlisted_effect,
)
from lta_challenge.make import load_challenge_vehicle
from lta_challenge.outside import OUTSIDE, RESERVED, STRANGE
from lta_challenge.truth_simulation import simulate_flight, TruthTrajectory
from lta_challenge.truth_vehicle import build_truth_vehicle
from lta_model.effects.protocol import Values, VehicleMotion
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
LATE = [name for name, one in OUTSIDE.items() if one.late]
LEVEL = Rotation.identity()
STILL = (0.0, 0.0, 0.0)
GONDOLA = np.array([0.0, 0.0, -0.4])
THRUST = (0.01, 0.02, 0.03, 0.04, 0.0, 0.0, 0.0, 0.0)  # N


def moving(
    position: Sequence[float] = (0.0, 0.0, 1.5),
    turn: Rotation = LEVEL,
    velocity: Sequence[float] = STILL,
    rates: Sequence[float] = STILL,
    command: Sequence[float] = (0.0,) * 8,
) -> VehicleMotion:
    """Return a motion in still air; velocity and rates in body axes."""
    rotation = tuple(turn.as_matrix().ravel().tolist())
    parts = (position, rotation, velocity, rates, velocity, (), command, ())
    return VehicleMotion(*map(tuple, parts))  # type: ignore[arg-type]


def pushed(name: str, motion: VehicleMotion, memory: Values = (), **given: float) -> Array:
    """Return the wrench of a kind."""
    effect = STRANGE[name].effect
    p = tuple(given[each.name] for each in effect.parameters)
    return np.array(effect.wrench(p, memory, motion, THRUST))


def changed(
    name: str,
    during: Callable[[float], VehicleMotion],
    seconds: float,
    begin: Values,
    **given: float,
) -> Array:
    """Return the memory of a kind every 10 ms, by another integrator."""
    effect = STRANGE[name].effect
    p = tuple(given[each.name] for each in effect.parameters)
    times = np.arange(0.0, seconds, 0.01)
    done = solve_ivp(
        lambda t, m: effect.rate(p, tuple(m), during(t)),
        (0.0, seconds), begin, t_eval=times, max_step=0.005,
    )  # fmt: skip
    return np.asarray(done.y.T, dtype=np.float64)


def test_half_of_the_cases_have_kinds_that_were_written_late() -> None:
    assert len(LATE) >= 4
    draw = np.random.default_rng(0)
    for late in (False, True):
        drawn = {choose_outside_kind(draw, late=late) for _ in range(300)}
        assert drawn == {name for name, one in OUTSIDE.items() if one.late == late}
    for number in range(2):
        answer = (
            CaseGenerator(load_challenge_vehicle(), 4, number, 'base', 'outside', (20.0, 24.0))
            .generate_case()
            .answer
        )
        assert OUTSIDE[answer['outside']].late == bool(number)


def flight_with(
    name: str, number: int
) -> tuple[dict[str, float], TruthTrajectory, TruthTrajectory]:
    """Return a drawn kind, a flight with it as strong as ten floors, and one without it."""
    nominal = load_challenge_vehicle().nominal
    given = draw_outside_parameters(name, np.random.default_rng(number))
    course = ('climbs', 'steps', 'laps')[number % 3]

    def fly(some: dict[str, dict[str, float]]) -> TruthTrajectory:
        pilot = plan_pilot_inputs(course, 40.0, False, np.random.default_rng(number))
        return simulate_flight(build_truth_vehicle(nominal, some), pilot, nominal)

    for _ in range(3):
        happened = fly({name: given})
        given = scale_unlisted_effect(
            name, given, min(10.0 / max(wrench_strength(happened.strange), 0.5), 5.0)
        )
    return given, fly({name: given}), fly({})


@pytest.mark.parametrize('name', [*LATE, *RESERVED])
def test_each_acts_and_comes_to_what_was_asked_for(name: str) -> None:
    reached = []
    for number in range(3):
        given, happened, without = flight_with(name, number)
        assert np.isfinite(happened.strange).all()
        assert given['size'] <= STRANGE[name].effect.parameters[0].high
        reached.append(wrench_strength(happened.strange))
        # 2 g heavy and with rotors that push one way only: neither lost upwards nor far below.
        assert np.abs(happened.position[:, 2] - without.position[:, 2]).max() < 2.0
        assert happened.position[:, 2].min() > 0.0
        assert np.abs(happened.position - without.position).max() > 3e-3
    # A seam buckles only where the drone climbs far enough; cases draw weaker effects again
    assert sorted(reached)[1] > FAINT
    assert np.median(reached) == pytest.approx(10.0, rel=0.6)


@pytest.mark.parametrize('name', ['leash', 'plume'])
def test_the_compiled_truth_pushes_as_the_plain_function_does(name: str) -> None:
    given, happened, _ = flight_with(name, 1)
    for k in range(0, len(happened.position), 97):
        turn = Rotation.from_matrix(happened.rotation[k])
        motion = moving(happened.position[k], turn, happened.velocity[k], happened.rates[k])
        assert pushed(name, motion, **given) == pytest.approx(happened.strange[k], abs=1e-9)


@pytest.mark.long
def test_what_comes_to_nothing_is_drawn_again() -> None:
    # Rotors that hover do not stall.
    floors = []
    for number in (1, 3, 5, 7, 9, 11):
        answer = (
            CaseGenerator(load_challenge_vehicle(), 6, number, 'hover', 'outside', (20.0, 24.0))
            .generate_case()
            .answer
        )
        assert answer['outside'] != 'stall'
        floors.append(answer['floors'])
    assert min(floors) >= FAINT


def test_a_leash_is_slack_and_then_pulls_towards_its_stand() -> None:
    line = {'size': 0.01, 'length': 1.0, 'east': 0.0, 'north': 0.0}
    assert not pushed('leash', moving((0.6, 0.0, 0.9)), **line).any()
    # The gondola 3 m north of the stand and at its height, the nose to the east.
    for speed, factor in ((0.0, 1.0), (1.0, 1.3), (-1.0, 0.7)):
        motion = moving((0.0, 3.0, 0.4), velocity=(0.0, speed, 0.0))
        pull = 0.01 * factor
        expected = (0.0, -pull, 0.0, -0.4 * pull, 0.0, 0.0)
        assert pushed('leash', motion, **line) == pytest.approx(expected, abs=1e-10)
    stretched = pushed('leash', moving((0.0, 1.1, 0.4)), **line)
    assert stretched[1] == pytest.approx(-0.01 * (1.0 - 1.0 / math.e))


def test_a_leash_takes_energy_and_gives_none() -> None:
    line = {'size': 0.01, 'length': 1.0, 'east': 0.2, 'north': -0.3}
    turns = Rotation.from_euler('zyx', np.random.default_rng(3).normal(0.0, 0.4, (50, 3)))
    for k, turn in enumerate(turns):
        there = turn.inv().apply([0.4, 0.2, -0.1])
        place = np.array([2.0, 1.0, 1.5 + 0.01 * k])
        wrench = pushed('leash', moving(place, turn, there), **line)
        back = pushed('leash', moving(place, turn, -there), **line)
        assert wrench[:3] @ there + back[:3] @ -there < 0.0
        assert wrench[3:] == pytest.approx(np.cross(GONDOLA, wrench[:3]), abs=1e-12)
        to_stand = np.array([0.2, -0.3, 0.0]) - (place + turn.apply(GONDOLA))
        along = turn.apply(wrench[:3])
        assert along / np.linalg.norm(along) == pytest.approx(to_stand / np.linalg.norm(to_stand))


@pytest.mark.long
def test_a_seam_has_hysteresis_of_the_width_that_is_asked_for() -> None:
    given = {'size': 0.004, 'half': 0.1, 'lever': 0.15}
    rate = OUTSIDE['seam'].effect.rate
    p = (0.004, 0.1, 0.15)
    # 10 cm below where the pressure is even it buckles, 10 cm above it springs back.
    for a, above, leaves in ((1.0, -0.09, False), (1.0, -0.11, True), (-1.0, 0.11, True)):
        for _ in range(4000):
            a += 0.01 * rate(p, (a, 1.5), moving((0.0, 0.0, 1.5 + above)))[0]
        assert (a * above > 0.0) == leaves
    # Up and down by 0.3 m every 20 s: it buckles and springs back once in each.
    waves = changed(
        'seam',
        lambda t: moving((0.0, 0.0, 1.5 + 0.3 * math.sin(math.pi * t / 10.0))),
        60.0, (1.0, 1.5), **given,
    )  # fmt: skip
    assert np.count_nonzero(np.diff(np.sign(waves[:, 0]))) in (5, 6)
    # It lacks nothing while taut and twice its size while buckled, off the middle.
    turn = Rotation.from_euler('zyx', [0.3, 0.2, -0.1])
    assert not pushed('seam', moving(turn=turn), (1.2, 1.5), **given).any()
    lacks = pushed('seam', moving(turn=turn), (-1.2, 1.5), **given)
    assert turn.apply(lacks[:3]) == pytest.approx([0.0, 0.0, -0.008])
    assert lacks[3:] == pytest.approx(np.cross([0.15, 0.0, 0.0], lacks[:3]))


@pytest.mark.long
def test_rotors_stall_while_sinking_and_recover_late() -> None:
    given = {'size': 0.5, 'middle': 0.04, 'half': 0.02}

    def sinking(t: float) -> VehicleMotion:
        # From rest to 8 cm/s down and back within 80 s.
        return moving(velocity=(0.0, 0.0, -0.08 * (1.0 - abs(t - 40.0) / 40.0)))

    wash = changed('stall', sinking, 80.0, (-1.0,), **given)[:, 0]
    speed = np.array([-sinking(0.01 * k).airspeed[2] for k in range(len(wash))])
    begins, ends = np.flatnonzero(np.diff(np.sign(wash)))
    assert speed[begins] == pytest.approx(0.06, abs=0.004)
    assert speed[ends] == pytest.approx(0.02, abs=0.004)
    assert not pushed('stall', moving(), (-1.1,), **given).any()
    lost = pushed('stall', moving(), (1.1,), **given)
    assert lost == pytest.approx([0.0, 0.0, -0.5 * 0.03, 0.0, 0.0, 0.0])


def test_warm_air_rises_over_its_patch_and_is_drawn_in() -> None:
    patch = {'size': 0.01, 'wide': 0.5, 'east': 1.0, 'north': -1.0}
    over = pushed('plume', moving((1.0, -1.0, 1.0)), **patch)
    assert over == pytest.approx([0.0, 0.0, 0.008, 0.0, 0.0, 0.0], abs=1e-15)
    assert pushed('plume', moving((5.0, 3.0, 1.0)), **patch) == pytest.approx(over, abs=1e-12)
    beside = pushed('plume', moving((1.2, -1.0, 1.0)), **patch)
    assert beside[2] == pytest.approx(0.01 * (math.exp(-0.5 * 0.4**2) - 0.2), rel=0.01)
    drawn = 0.5 * 0.01 * math.exp(-1.0) * 0.4 * math.exp(-0.5 * 0.4**2)
    assert beside[0] == pytest.approx(-drawn, rel=0.04)
    # As much sinks as rises, within the tenth of the size.
    grid = 4.0 * np.arange(40) / 40.0
    mean = np.mean([pushed('plume', moving((x, y, 1.0)), **patch)[2] for x in grid for y in grid])
    assert abs(mean) < 0.1 * 0.01


@pytest.mark.long
def test_a_charge_is_drawn_by_its_image() -> None:
    coulomb = (1e-6) ** 2 / (16.0 * math.pi * 8.8541878128e-12)
    assert coulomb == pytest.approx(2.2e-3, rel=0.03)
    given = {'size': coulomb, 'leak': 20.0, 'normal': 0.5 * math.pi, 'away': 1.0}

    def pull(way: float) -> float:
        return float(pushed('charged', moving((7.0, 1.0 - way, 1.0)), (1.0,), **given)[1])

    # Near it as the formula has it; to either side; half-way and at a curtain nothing.
    assert pull(0.2) == pytest.approx(coulomb * 0.2 / (0.2**2 + 0.5**2) ** 1.5, rel=0.02)
    assert pull(-0.2) == pytest.approx(-pull(0.2))
    assert [pull(0.0), pull(2.5), pull(-2.5)] == pytest.approx([0.0] * 3, abs=1e-12)
    assert pull(5.2) == pytest.approx(pull(0.2))
    half = pushed('charged', moving((7.0, 0.8, 1.0)), (0.5,), **given)
    assert half[1] == pytest.approx(0.25 * pull(0.2))
    # Rubbed at 0.5 m/s, leaking in 20 s: 0.1 (1 - q) = 0.05 q.
    end = changed('charged', lambda _: moving(velocity=(0.3, 0.0, 0.4)), 80.0, (0.5,), **given)
    assert end[-1, 0] == pytest.approx(2.0 / 3.0, abs=1e-4)


def test_a_battery_slides_to_its_stop_and_stays() -> None:
    given = {'size': 0.3, 'half': 0.02, 'grip': 0.03}

    def pitched(t: float) -> VehicleMotion:
        # Nose down by 0.05 for a second, level, a little up, far up.
        sines = (0.05, 0.0, -0.02, -0.08)
        return moving(turn=Rotation.from_euler('y', math.asin(sines[min(int(t), 3)])))

    way = changed('tray', pitched, 4.0, (0.0,), **given)[:, 0]
    assert way[50] == pytest.approx(0.5 * (0.05 - 0.03), rel=0.02)
    assert way[110:299] == pytest.approx(0.02, abs=4e-4)
    assert way[-1] == pytest.approx(-0.02, abs=4e-4)
    turn = Rotation.from_euler('zyx', [0.4, 0.1, 0.2])
    weight = turn.inv().apply([0.0, 0.0, -0.3])
    moment = pushed('tray', moving(turn=turn), (0.015,), **given)
    assert moment[3:] == pytest.approx(np.cross([0.015, 0.0, 0.0], weight))
    assert not moment[:3].any()


def test_a_motor_loses_step_at_a_jump_and_not_at_a_slope() -> None:
    given = {'size': 0.5, 'jump': 0.1, 'back': 0.4}

    def told(duty: float) -> VehicleMotion:
        return moving(command=(0.9, 0.9, duty, 0.9, 0.0, 0.0, 0.0, 0.0))

    slope = changed('desync', lambda t: told(0.5 * t), 1.0, (0.0, 0.0), **given)
    assert not slope[:, 0].any()  # 0.1 s behind at 0.5 a second
    jump = changed('desync', lambda t: told(0.3), 1.0, (0.0, 0.0), **given)[:, 0]
    # It slips until the filter is within 0.1 of 0.3: for 0.1 s ln 3.
    slips = 0.1 * math.log(3.0)
    most = 40.0 / 42.5 * (1.0 - math.exp(-42.5 * slips))
    assert jump.max() == pytest.approx(most, rel=0.03)
    assert jump[90] / jump[50] == pytest.approx(math.exp(-1.0), rel=0.01)
    lost = pushed('desync', moving(), (1.0, 0.0), **given)
    assert lost[:3] == pytest.approx([-0.015, 0.0, 0.0])
    assert lost[3:] == pytest.approx(np.cross([0.0, 0.1, -0.4], lost[:3]))


@pytest.mark.long
def test_a_wet_hull_dries_faster_in_the_wind() -> None:
    given = {'size': 0.02, 'takes': 60.0}
    still = changed('drying', lambda _: moving(), 60.0, (1.0,), **given)[-1, 0]
    windy = changed('drying', lambda _: moving(velocity=(0.0, 0.3, 0.0)), 60.0, (1.0,), **given)
    assert still == pytest.approx(math.exp(-1.0), rel=1e-3)
    assert windy[-1, 0] == pytest.approx(math.exp(-2.0), rel=1e-3)
    turn = Rotation.from_euler('zyx', [0.4, 0.1, 0.2])
    weight = pushed('drying', moving(turn=turn), (0.5,), **given)
    assert turn.apply(weight[:3]) == pytest.approx([0.0, 0.0, -0.01])


def test_sizes_end_where_the_vehicle_would_no_longer_fly() -> None:
    given = scale_unlisted_effect('plume', {'size': 0.02, 'wide': 0.5}, 4.0)
    assert given == {'size': 0.025, 'wide': 0.5}
