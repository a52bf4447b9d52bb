"""Which mount wins, and by how much: steadiness, light, power, and what the hull can carry."""

from collections.abc import Mapping
import math

from lta_model.electrical.charger import charger_output
from lta_model.electrical.panel import find_max_power
from lta_model.vehicle import Vehicle
from lta_studies.energy.mounting.run import MountingStudy
from lta_studies.energy.mounting.straight_flight import average_over_seeds
from lta_vehicle.figures.mass_budget import DEGREES

IRRADIANCE = 80e3 / 300.0  # W/m2: 80 klux (seed paper) of a white LED of 300 lm/W


def mean_light_share(study: MountingStudy) -> dict[str, float]:
    """Return the mean over the lights of what the string of panels gets, by mount. [1]"""
    return {
        name: math.fsum(at.series for at in found.values()) / len(found)
        for name, found in study.light.items()
    }


def pitch_rms(study: MountingStudy) -> dict[str, float]:
    """Return the deviation of pitch on the way, in the hull that carries all. [rad]"""
    return {
        name: average_over_seeds(each.flights, 'rms').mean for name, each in study.shared.items()
    }


def mean_power(study: MountingStudy) -> dict[str, float]:
    """Return the mean power on the way, in the hull that carries all. [W]"""
    return {
        name: average_over_seeds(each.flights, 'power').mean for name, each in study.shared.items()
    }


def charger_power(study: MountingStudy, light: str) -> dict[str, float]:
    """Return what the charger gives at 80 klux of white LED from a direction, by mount. [W]"""
    return {
        name: _charger_output(each.fitted.vehicle, IRRADIANCE * study.light[name][light].series)
        for name, each in study.shared.items()
    }


def _charger_output(vehicle: Vehicle, irradiance: float) -> float:
    """Return what array and charger give; the darkest panel's light stands for all. [W]"""
    voltage, current = find_max_power(vehicle.panel, irradiance)
    return charger_output(vehicle.charger, voltage * current)


def find_best_mount(study: MountingStudy) -> str:
    """Return the mount with most light among those that the hull carries, or among all."""
    found = mean_light_share(study)
    able = {name: found[name] for name in study.own} or found
    return max(able, key=lambda name: able[name])


def format_title(study: MountingStudy) -> str:
    """Return what came out, in a sentence."""
    won, light, swing = find_best_mount(study), mean_light_share(study), pitch_rms(study)
    steady = min(swing, key=lambda name: swing[name])
    text = f'{won.capitalize()} gets most light of what the hull can carry'
    if len(light) > 1 and steady != won:
        heavy = study.lacking[steady]
        why = f', {1e3 * heavy:.1f}\N{NO-BREAK SPACE}g too heavy to fly,' if heavy > 0.0 else ''
        text += f'; {steady}{why} swings {100.0 * (1.0 - swing[steady] / swing[won]):.0f} % less'
    return f'{text}.'


def format_findings(study: MountingStudy) -> list[str]:
    """Return the findings, one a line."""
    told = []
    for name, short in study.lacking.items():
        if short > 0.0:
            told.append(
                f"{name}: {1e3 * short:.1f} g heavier than the hull can carry at the file's "
                f'heaviness; a hull of the same outline would have to be '
                f'{100.0 * (study.fuller - 1.0):.1f} % fuller.'
            )
    told.append(
        'In that hull, at equal lift: '
        + format_ranking('pitch rms', pitch_rms(study), DEGREES, '°', 3)
        + '; '
        + format_ranking('power in flight', mean_power(study), 1e3, 'mW', 0)
        + '.'
    )
    told.extend(
        format_ranking(
            f'Harvest at 80 klux of white LED, {light}', charger_power(study, light), 1e3, 'mW', 0
        )
        + ', behind the charger.'
        for light in ('overhead', 'overcast sky')
    )
    askew = {
        name: average_over_seeds(each.flights, 'swing').mean
        for name, each in study.misplaced.items()
    }
    told.append(
        f'With the panels {100.0 * study.ahead:g} cm out of place: '
        + format_ranking('swing after lift-off', askew, DEGREES, '°', 2)
        + '; the seed paper saw ±2.5° of the side mount.'
    )
    return told


def format_ranking(
    words: str, values: Mapping[str, float], factor: float, unit: str, digits: int
) -> str:
    """Return figures by mount, the least first."""
    order = sorted(values, key=lambda name: values[name])
    gap = '' if unit == '°' else ' '
    told = [f'{name} {factor * values[name]:.{digits}f}{gap}{unit}' for name in order]
    return f'{words} {", ".join(told)}'
