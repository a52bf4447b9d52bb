# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Repeat the paper's study of the number of photodiodes, and find the causes of its errors."""

from collections.abc import Mapping
import math
from typing import Any, Final

from lta_config.command_line import format_lta_command
from lta_flight.flight_spec import build_vehicle_scenario_stack
from lta_report.charts import draw_polar
from lta_studies.light.bearing.bench import (
    BEARING_PLACES,
    BearingBench,
    build_flight_spec,
    count_accurate_directions,
    describe_method,
    DIODES_PATH,
    DIRECTION_COUNT,
    READINGS_PER_DIRECTION,
    RING_COLOURS,
    RING_COUNTS,
    RingStudy,
    STUDY_OFF_AXIS,
    study_ring,
)
from lta_studies.reproduce.study_result import (
    average_measures,
    average_over_seeds,
    collect_draws,
    RowStudyRequest,
    RowStudyResult,
    StudyPicture,
    to_values,
)
import numpy as np

QUICK_READINGS, DRAW_READINGS = 10, 1  # readings per direction with --quick, and in a draw
ASIDES: Final = (
    STUDY_OFF_AXIS,
    0.0,
)  # readings of where the drone stands, off the lamp's axis [rad]
ERROR_LIMITS: Final = ((16, 2), (8, 4), (8, 8), (4, 10))  # diodes, and limit of their errors [deg]
CLAIMED: Final = (
    'indoor_16_below_2', 'indoor_8_below_4', 'indoor_8_below_8', 'indoor_4_below_10',
    'four_good_midway', 'outdoor_by_indoor_8', 'outdoor_eight_by_sixteen',
    'worst_outdoor_by_indoor_4', 'indoor_8_worst', 'indoor_16_worst',
)  # fmt: skip
GOOD_ERROR: Final = math.radians(2.0)
DARK_WALLS: Final = {'scenario.room.albedo': 0.0}
NARROW_DIODES: Final = {
    f'{DIODES_PATH}.response': {'value': 2.0, 'unit': '1', 'source': 'ablation'}
}
UNEQUAL: Final = {f'{DIODES_PATH}.gain_spread': {'value': 10, 'unit': '%', 'source': 'ablation'}}
DIODE_ABLATIONS: Final = (
    ('sixteen_worst_dark_walls', 16, DARK_WALLS),
    ('four_worst_narrow', 4, NARROW_DIODES),
    ('eight_worst_unequal', 8, UNEQUAL),
)


def run_study(request: RowStudyRequest) -> RowStudyResult:
    """Study both places; each seed is one vehicle with its own diode gains."""
    readings = QUICK_READINGS if request.quick else READINGS_PER_DIRECTION
    vehicles = [study_vehicle({}, readings, seed) for seed in range(1, request.seeds + 1)]
    values = average_measures([measure_readings(each) for each in vehicles])
    for name, count, changes in DIODE_ABLATIONS:
        rings = [
            study_count('indoor', count, changes, readings, seed, STUDY_OFF_AXIS)
            for seed in range(1, request.seeds + 1)
        ]
        values[name] = average_over_seeds([max(ring.paper) for ring in rings])
    values |= to_values(weigh_diodes({}))
    draws = collect_draws(
        request,
        lambda seed: measure_draw(request.draw_changes(seed), seed),
    )
    command = format_lta_command('reproduce', 'photodiodes')
    pictures = [
        StudyPicture(
            place, f'{place.capitalize()}: {BEARING_PLACES[place].about}',
            'Median bearing error as the radius [°], by direction of the lamp. Seed 1. '
            f'{describe_method(STUDY_OFF_AXIS)}',
            draw_polar({
                f'{count} diodes': (
                    vehicles[0][STUDY_OFF_AXIS, place, count].paper, RING_COLOURS[count],
                )
                for count in RING_COUNTS
            }),
            command,
        )
        for place in BEARING_PLACES
    ]  # fmt: skip
    return RowStudyResult(values, pictures, draws=draws)


def measure_draw(changes: Mapping[str, Any], seed: int) -> dict[str, float]:
    """Return the measures of a draw."""
    return measure_readings(study_vehicle(changes, DRAW_READINGS, seed)) | weigh_diodes(changes)


def weigh_diodes(changes: Mapping[str, Any]) -> dict[str, float]:
    """Return the mass of eight diodes by that of the drone and by its spare lift [1]."""
    own = {path: each for path, each in changes.items() if path.startswith('vehicle')}
    spec = build_flight_spec(BEARING_PLACES['indoor'], 'gtmab', 8).with_values(own)
    vehicle = build_vehicle_scenario_stack(spec)[0]
    eight = vehicle.file.parts['light_sensors'].mass.si
    return {
        'diodes_by_mass': eight / vehicle.mass, 'diodes_by_spare': eight / vehicle.ballast_mass,
    }  # fmt: skip


# The studies of one vehicle, by angle to the lamp's axis [rad], place and number of diodes
VehicleStudies = Mapping[tuple[float, str, int], RingStudy]


def study_vehicle(changes: Mapping[str, Any], readings: int, seed: int) -> VehicleStudies:
    """Study all rings of one vehicle in both places and readings of the lamp's angle."""
    return {
        (aside, place, count): study_count(place, count, changes, readings, seed, aside)
        for aside in ASIDES
        for place in BEARING_PLACES
        for count in RING_COUNTS
    }


def study_count(
    place: str, count: int, changes: Mapping[str, Any], readings: int, seed: int, aside: float
) -> RingStudy:
    """Study one ring of a changed vehicle in one place."""
    # The ranges of the row are those of the room
    own = {p: each for p, each in changes.items() if place == 'indoor' or p.startswith('vehicle')}
    spec = build_flight_spec(BEARING_PLACES[place], 'gtmab', count).with_values(own)
    # A draw of the vehicle's own resistor does not change the one that is mounted for the sun
    spec = spec.with_values(BEARING_PLACES[place].mounted)
    return study_ring(BearingBench(spec), place, count, readings, seed, aside)


def measure_readings(studies: VehicleStudies) -> dict[str, float]:
    """Return the measures of one vehicle for both readings of the lamp's angle."""
    values = measure_vehicle(studies, STUDY_OFF_AXIS)
    straight = measure_vehicle(studies, 0.0)
    return values | {f'straight_{name}': straight[name] for name in CLAIMED}


def measure_vehicle(studies: VehicleStudies, aside: float) -> dict[str, float]:
    """Return the measures of one vehicle at an angle to the lamp's axis [rad]."""
    errors = {(p, n): ring.paper for (angle, p, n), ring in studies.items() if angle == aside}
    middle = {key: float(np.median(each)) for key, each in errors.items()}
    values = {}
    for (place, count), each in errors.items():
        values[f'{place}_{count}_median'] = middle[place, count]
        values[f'{place}_{count}_worst'] = max(each)
    for count in RING_COUNTS:
        values[f'outdoor_by_indoor_{count}'] = middle['outdoor', count] / middle['indoor', count]
    values['outdoor_eight_by_sixteen'] = middle['outdoor', 8] / middle['outdoor', 16]
    values['worst_outdoor_by_indoor_4'] = max(errors['outdoor', 4]) / max(errors['indoor', 4])
    for count, degrees in ERROR_LIMITS:
        values[f'indoor_{count}_below_{degrees}'] = float(
            count_accurate_directions(errors['indoor', count], math.radians(degrees))
        )
    values['four_good_midway'] = midway_share(studies[aside, 'indoor', 4])
    return values


def midway_share(ring: RingStudy) -> float:
    """Return the share of low-error directions that lie midway between two diodes."""
    good = [k for k, error in enumerate(ring.paper) if error < GOOD_ERROR]
    # Test directions per diode spacing
    step = DIRECTION_COUNT // ring.count
    return sum(k % step == step // 2 for k in good) / len(good) if good else math.nan
