"""Summarize the mount comparison: pitch, light, power and carrying capacity."""

from collections.abc import Mapping
import math

from lta_config.schema.spectrum_file import luminous_efficacy
from lta_energy.harvest import WHITE_LED
from lta_model.electrical.charger import charger_output
from lta_model.electrical.panel import array_spectral_factor, find_max_power_point
from lta_model.vehicle import Vehicle
from lta_studies.energy.mounting.run import MountingStudy
from lta_studies.energy.mounting.straight_flight import average_over_seeds
from lta_vehicle.figures.mass_budget import DEGREES

LAMP_LUX = 80e3  # lx, seed paper


def mean_light_share(study: MountingStudy) -> dict[str, float]:
    """Return the light on the panels in series, mean over the lights, by mount. [1]"""
    return {
        name: math.fsum(at.series for at in shares.values()) / len(shares)
        for name, shares in study.light.items()
    }


def pitch_rms(study: MountingStudy) -> dict[str, float]:
    """Return the rms pitch in flight, in the hull that carries all mounts. [rad]"""
    return {
        name: average_over_seeds(each.flights, 'rms').mean for name, each in study.shared.items()
    }


def mean_flight_power(study: MountingStudy) -> dict[str, float]:
    """Return the mean flight power, in the hull that carries all mounts. [W]"""
    return {
        name: average_over_seeds(each.flights, 'power').mean for name, each in study.shared.items()
    }


def charger_power(study: MountingStudy, light: str) -> dict[str, float]:
    """Return the charger output at 80 klux of white LED from a direction, by mount. [W]"""
    return {
        name: _charger_output(each.fitted.vehicle, study.light[name][light].series)
        for name, each in study.shared.items()
    }


def _charger_output(vehicle: Vehicle, share: float) -> float:
    """Return the charger output with a share of the lamp's light on the darkest panel. [W]"""
    efficacy = luminous_efficacy(WHITE_LED)
    irradiance = LAMP_LUX / efficacy * array_spectral_factor(vehicle.file.energy, efficacy)
    voltage, current = find_max_power_point(vehicle.panel, irradiance * share)
    return charger_output(vehicle.charger, voltage * current)


def find_best_mount(study: MountingStudy) -> str:
    """Return the mount with the most light among those the hull carries, else among all."""
    shares = mean_light_share(study)
    # `own` holds the mounts that the hull can carry.
    able = {name: shares[name] for name in study.own} or shares
    return max(able, key=lambda name: able[name])


def format_headline(study: MountingStudy) -> str:
    """Return the headline."""
    won, light, swing = find_best_mount(study), mean_light_share(study), pitch_rms(study)
    steady = min(swing, key=lambda name: swing[name])
    text = f'{won.capitalize()} gets the most light of the mounts that the hull can carry'
    if len(light) > 1 and steady != won:
        heavy = study.lacking[steady]
        why = f', {1e3 * heavy:.1f}\N{NO-BREAK SPACE}g too heavy to fly,' if heavy > 0.0 else ''
        text += (
            f'; {steady}{why} oscillates {100.0 * (1.0 - swing[steady] / swing[won]):.0f} % '
            'less in pitch'
        )
    return f'{text}.'


def format_findings(study: MountingStudy) -> list[str]:
    """Return the findings as sentences."""
    sentences = []
    for name, short in study.lacking.items():
        if short > 0.0:
            sentences.append(
                f'With the mount {name}, the vehicle is {1e3 * short:.1f} g heavier than '
                'trim.heaviness in the vehicle file allows; a hull of the same outline would '
                f'need {100.0 * (study.fuller - 1.0):.1f} % more volume.'
            )
    sentences.append(
        'In a hull large enough for every mount, at equal lift: '
        + format_ranking('rms pitch', pitch_rms(study), DEGREES, '°', 3)
        + '; '
        + format_ranking('power in flight', mean_flight_power(study), 1e3, 'mW', 0)
        + '.'
    )
    sentences.extend(
        format_ranking(
            f'Charger output at 80 klx of white LED light ({light}):',
            charger_power(study, light),
            1e3,
            'mW',
            0,
        )
        + ', after the charger.'
        for light in ('overhead', 'overcast sky')
    )
    swings = {
        name: average_over_seeds(each.flights, 'swing').mean
        for name, each in study.misplaced.items()
    }
    sentences.append(
        f'With the panels {100.0 * study.ahead:g} cm too far forward: '
        + format_ranking('pitch oscillation after lift-off', swings, DEGREES, '°', 2)
        + '; the paper (Huang et al. 2025) reports ±2.5° for the side mount.'
    )
    return sentences


def format_ranking(
    words: str, values: Mapping[str, float], factor: float, unit: str, digits: int
) -> str:
    """Format values by mount in ascending order."""
    order = sorted(values, key=lambda name: values[name])
    gap = '' if unit == '°' else ' '
    entries = [f'{name} {factor * values[name]:.{digits}f}{gap}{unit}' for name in order]
    return f'{words} {", ".join(entries)}'
