"""Draw the course of a challenge flight: laps, climbs, steps, hover, random waypoints."""

from collections.abc import Callable
from typing import Final

from lta_challenge.truth_flight import TICK
from lta_challenge.truth_simulation import PilotInputs
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Draw = np.random.Generator
Course = Callable[[Array, Draw], Array]

SEEN: Final = (0.01, 0.01, 0.02)  # m, rad, m/s: noise of what the pilot sees
SHAKEN: Final = (0.08, 0.2)  # of a duty; a flight's amplitude
HOVERED: Final = (0.02, 0.05)  # the same where nothing but hovering is wanted
EACH: Final = (0.4, 1.2)  # s; a shake lasts
QUIET: Final = 3.0  # s; at the beginning


def _hold_values(
    time: Array, draw: Draw, each: tuple[float, float], *values: Array
) -> list[Array]:
    """Return values that hold for a while each; `values` have one number a while."""
    edges = np.cumsum(draw.uniform(*each, size=len(values[0])))
    index = np.minimum(np.searchsorted(edges, time, side='right'), len(values[0]) - 1)
    return [value[index] for value in values]


def _count_holds(time: Array, least: float) -> int:
    """Return how many whiles of a least length a flight can have."""
    return int(time[-1] / least) + 2


def plan_laps(time: Array, draw: Draw) -> Array:
    """Round and round, now and then the other way."""
    count = _count_holds(time, 15.0)
    rate = draw.uniform(0.12, 0.3, count) * draw.choice([-1.0, 1.0], count)
    height, speed = draw.uniform(1.2, 2.0, count), draw.uniform(0.3, 0.7, count)
    high, turning, fast = _hold_values(time, draw, (15.0, 30.0), height, rate, speed)
    return np.column_stack([high, np.cumsum(turning) * TICK, fast])


def plan_climbs(time: Array, draw: Draw) -> Array:
    """Up and down, hardly ahead."""
    count = _count_holds(time, 6.0)
    heights, speeds = draw.uniform(1.1, 2.7, count), draw.uniform(0.0, 0.2, count)
    high, fast = _hold_values(time, draw, (6.0, 12.0), heights, speeds)
    return np.column_stack([high, 0.05 * time, fast])


def plan_steps(time: Array, draw: Draw) -> Array:
    """All at once, every 8 s or so."""
    count = _count_holds(time, 6.0)
    heights, turns = draw.uniform(1.2, 2.2, count), np.cumsum(draw.uniform(-2.0, 2.0, count))
    speeds = draw.choice([0.0, 0.3, 0.6], count)
    high, ahead, fast = _hold_values(time, draw, (6.0, 10.0), heights, turns, speeds)
    return np.column_stack([high, ahead, fast])


def plan_hover(time: Array, draw: Draw) -> Array:
    """Stay."""
    height, heading = draw.uniform(1.2, 1.8), draw.uniform(-3.0, 3.0)
    return np.column_stack([np.full_like(time, height), np.full_like(time, heading), 0.0 * time])


def plan_wandering(time: Array, draw: Draw) -> Array:
    """Now here, now there, smoothly."""

    def random_walk(size: float, forgets: float) -> Array:
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
    Return what the pilot of one flight is told.

    Parameters
    ----------
    course : str
        Of COURSES.
    seconds : float
        Its length. [s]
    pushed : bool
        Whether the vehicle is commanded by a wrench.
    draw : Generator
        Where chance comes from.

    """
    time = TICK * np.arange(round(seconds / TICK), dtype=np.float64)
    wanted = COURSES[course](time, draw)
    size = draw.uniform(*(HOVERED if course == 'hover' else SHAKEN))
    count = _count_holds(time, EACH[0])
    axes = size * draw.uniform(-1.0, 1.0, (6, count))
    heave, roll, surge, yaw, sway, pitch = _hold_values(time, draw, EACH, *axes)
    shaken = np.zeros((len(time), 8))
    if pushed:
        # In parts of the limits of surge, sway, heave, roll, pitch, yaw.
        shaken[:, :6] = 2.0 * np.column_stack([surge, sway, heave, roll, pitch, yaw])
    else:
        shaken[:, :4] = np.column_stack([heave + roll, heave - roll, surge + yaw, surge - yaw])
    shaken[time < QUIET] = 0.0
    return PilotInputs(wanted, draw.standard_normal((len(time), 3)) * SEEN, shaken, pushed)
