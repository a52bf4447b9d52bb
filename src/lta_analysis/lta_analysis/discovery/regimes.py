"""Regimes in which flights were flown, and whether what they name carries over to others."""

from collections.abc import Sequence
from typing import Final

from lta_analysis.discovery.foresight import Foresight
from lta_analysis.discovery.linearise import Linearised
from lta_analysis.discovery.study import Study
from lta_analysis.discovery.transfer import left_out, warning
import numpy as np

ENOUGH: Final = 8  # flights
EACH: Final = 2  # flights in a regime, and outside of it
APART: Final = 1e-3  # m; between places of a moving mass
FASTER: Final = 1.3  # times; less is the same speed
ROUNDS: Final = 2
LIFT: Final = 0.004  # N; by which the lift of a flight may be off (as between RGBlimp's repeats)


def regimes(flights: Sequence[Linearised]) -> dict[str, list[int]]:
    """
    Return flights by where a moving mass was, and by slow and fast.

    Parameters
    ----------
    flights : sequence of Linearised
        Of one vehicle.

    Returns
    -------
    dict of str to list of int
        Flights by the name of the regime; only those with flights enough inside and outside.

    """
    out: dict[str, list[int]] = {}
    speeds = []
    for f, flight in enumerate(flights):
        start, mass = flight.replay.cut.start, flight.replay.flight.mass
        speeds.append(float(np.median(np.linalg.norm(start[:, 7:10], axis=1))))
        if mass is not None:
            place = APART * round(float(np.median(mass.values[:, 0])) / APART)
            out.setdefault(f'moving mass at {place:.3f} m', []).append(f)
    middle = float(np.median(speeds))
    slow = [f for f, speed in enumerate(speeds) if speed < middle]
    fast = [f for f, speed in enumerate(speeds) if speed >= middle]
    if slow and np.median([speeds[f] for f in fast]) > FASTER * np.median(
        [speeds[f] for f in slow]
    ):
        out[f'slower than {middle:.2f} m/s'], out[f'{middle:.2f} m/s or faster'] = slow, fast
    return {
        name: inside for name, inside in out.items() if EACH <= len(inside) <= len(flights) - EACH
    }


def interpolation(found: Study) -> str:
    """
    Return a sentence where what was named does not carry over to a regime left out, else ''.

    Of the flights that taught and confirmed, where there are enough of them, by their forecasts.
    """
    flights = [one.flight for one in found.flights if one.role != 'holdout']
    flights = [one for one in flights if one.replay.cut.inside[:, -1].any()]
    knobs = [knob for effect in found.finding.effects for knob in effect.knobs]
    groups = regimes(flights) if knobs and len(flights) >= ENOUGH else {}
    if not groups:
        return ''
    foresight = Foresight(found.nominal, flights, LIFT)
    which = [k for k, knob in enumerate(foresight.knobs) if knob.name in knobs]
    known = [foresight.knobs[k] for k in which]
    spread = np.array([max(knob.typical, 2.0 * knob.tolerance) for knob in known])
    fitted = foresight.fit(which, spread, range(len(flights)), rounds=ROUNDS)
    names = [effect.name for effect in found.finding.effects]
    return warning(names, left_out(foresight, fitted, which, spread, groups))
