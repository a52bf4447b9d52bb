"""Draw the course of a challenge flight: laps, climbs, steps, hover, random waypoints."""

from collections.abc import Callable
from typing import Final

from lta_challenge.truth_flight import PilotInputs, TICK
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Draw = np.random.Generator
Course = Callable[[Array, Draw], Array]

SEEN: Final = (0.01, 0.01, 0.02)  # m, rad, m/s; noise of height, heading and speed for the pilot
SHAKEN: Final = (0.08, 0.2)  # duty; range of the excitation's amplitude
HOVERED: Final = (0.02, 0.05)  # duty; the same for hover flights
EACH: Final = (0.4, 1.2)  # s; duration of each excitation value
QUIET: Final = 3.0  # s; no excitation at the start


def _hold_values(
    time: Array, draw: Draw, each: tuple[float, float], *values: Array
) -> list[Array]:
    """Return piecewise constant series, with one value per random hold time."""
    edges = np.cumsum(draw.uniform(*each, size=len(values[0])))
    index = np.minimum(np.searchsorted(edges, time, side='right'), len(values[0]) - 1)
    return [value[index] for value in values]


def _count_holds(time: Array, least: float) -> int:
    """Return the largest number of hold times of a minimum length in a flight."""
    # One for the rest of the division and one as a margin
    return int(time[-1] / least) + 2


def plan_laps(time: Array, draw: Draw) -> Array:
    """Fly circles whose direction changes at random."""
    count = _count_holds(time, 15.0)
    # rad/s; at 0.3 to 0.7 m/s the radius is between 1 and 6 m
    rate = draw.uniform(0.12, 0.3, count) * draw.choice([-1.0, 1.0], count)
    height, speed = draw.uniform(1.2, 2.0, count), draw.uniform(0.3, 0.7, count)
    high, turning, fast = _hold_values(time, draw, (15.0, 30.0), height, rate, speed)
    return np.column_stack([high, np.cumsum(turning) * TICK, fast])


def plan_climbs(time: Array, draw: Draw) -> Array:
    """Climb and descend with little forward speed."""
    count = _count_holds(time, 6.0)
    heights, speeds = draw.uniform(1.1, 2.7, count), draw.uniform(0.0, 0.2, count)
    high, fast = _hold_values(time, draw, (6.0, 12.0), heights, speeds)
    # rad/s; about one full turn in two minutes
    return np.column_stack([high, 0.05 * time, fast])


def plan_steps(time: Array, draw: Draw) -> Array:
    """Step height, heading and speed together, about every 8 s."""
    count = _count_holds(time, 6.0)
    heights, turns = draw.uniform(1.2, 2.2, count), np.cumsum(draw.uniform(-2.0, 2.0, count))
    speeds = draw.choice([0.0, 0.3, 0.6], count)
    high, ahead, fast = _hold_values(time, draw, (6.0, 10.0), heights, turns, speeds)
    return np.column_stack([high, ahead, fast])


def plan_hover(time: Array, draw: Draw) -> Array:
    """Hover at one height and heading."""
    height, heading = draw.uniform(1.2, 1.8), draw.uniform(-3.0, 3.0)
    return np.column_stack([np.full_like(time, height), np.full_like(time, heading), 0.0 * time])


def plan_wandering(time: Array, draw: Draw) -> Array:
    """Vary height, heading and speed as smooth random walks."""

    def random_walk(size: float, forgets: float) -> Array:
        # First-order autoregressive process with unit variance and this correlation time
        keep = np.exp(-TICK / forgets)
        noise, out = draw.standard_normal(len(time)), np.empty(len(time))
        now = draw.standard_normal()
        for k, each in enumerate(noise):
            now = keep * now + np.sqrt(1.0 - keep * keep) * each
            out[k] = now
        return size * out

    speed = np.clip(0.35 + random_walk(0.2, 12.0), 0.0, 0.7)
    heading = np.cumsum(random_walk(0.2, 6.0)) * TICK
    return np.column_stack([np.clip(1.7 + random_walk(0.35, 10.0), 1.1, 2.5), heading, speed])


COURSES: Final[dict[str, Course]] = {
    'laps': plan_laps,
    'climbs': plan_climbs,
    'steps': plan_steps,
    'hover': plan_hover,
    'wandering': plan_wandering,
}


def plan_pilot_inputs(course: str, seconds: float, pushed: bool, draw: Draw) -> PilotInputs:
    """
    Plan setpoints, noise and excitation of one flight.

    `course`: a key of `COURSES`. `seconds`: length of the flight [s]. `pushed`: whether the
    vehicle is commanded by a wrench.
    """
    time = TICK * np.arange(round(seconds / TICK), dtype=np.float64)
    course_inputs = COURSES[course](time, draw)
    size = draw.uniform(*(HOVERED if course == 'hover' else SHAKEN))
    count = _count_holds(time, EACH[0])
    # Draw all six axes in any case, so that the random numbers do not depend on `pushed`
    axes = size * draw.uniform(-1.0, 1.0, (6, count))
    heave, roll, surge, yaw, sway, pitch = _hold_values(time, draw, EACH, *axes)
    shaken = np.zeros((len(time), 8))
    if pushed:
        # In parts of the limits of surge, sway, heave, roll, pitch, yaw.
        shaken[:, :6] = 2.0 * np.column_stack([surge, sway, heave, roll, pitch, yaw])
    else:
        # Rotors: up left, up right, forward left, forward right
        shaken[:, :4] = np.column_stack([heave + roll, heave - roll, surge + yaw, surge - yaw])
    # The flight starts with a tilt, which must settle before the excitation
    shaken[time < QUIET] = 0.0
    return PilotInputs(course_inputs, draw.standard_normal((len(time), 3)) * SEEN, shaken, pushed)
