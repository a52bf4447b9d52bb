# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Study the light link: raw samples, lux and SNR by distance, and floor area per lamp."""

from collections.abc import Mapping, Sequence
from functools import partial
import math
from typing import Any, Final

from lta_config.command_line import format_lta_command
from lta_config.topics import load_topic_table
from lta_flight.flight_spec import build_vehicle_scenario_stack, load_spec
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_report.charts import ChartAxis, Curve, draw_curves
from lta_report.palette import ESTIMATE, TRUTH
from lta_studies.light.bearing.bench import FOR_SUN
from lta_studies.light.link.link_budget import (
    compute_lamp_link,
    LampLink,
    LinkPoint,
    LUX_CAPTION,
    plot_lux,
    plot_snr,
    simulate_block,
    SNR,
)
from lta_studies.light.plan.floor import build_floor
from lta_studies.light.plan.planner import list_mounts, plan_layout
from lta_studies.light.plan.request import load_inputs
from lta_studies.reproduce.study_result import (
    collect_draws,
    MeasuredValue,
    RowStudyRequest,
    RowStudyResult,
    StudyPicture,
)
from lta_vlc.receiver import BeaconReceiver
from lta_vlc.settings import DemodulationSettings
import numpy as np
from plotly.graph_objects import Figure

LINK_VEHICLE: Final = 'gtmab'
INDOOR_SCENARIO, DUSK, DAYLIGHT_SCENARIO = 'lamp_room', 'open_field', 'sunny_field'
LINK_DISTANCES: Final = (1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0)  # m
PAPER_RANGE: Final = 7.0  # m, seed paper
LINK_ALTITUDE: Final = 1.3  # m, of the hull centre; puts the diodes at the height of the lamp
TRACE: Final = 3.0  # m
SHOWN_SAMPLES: Final = 300  # samples, 30 ms
TRACED: Final = (
    'ADC counts at 10 kS/s, 3 m from the lamp in a room, of the diode that faces the lamp '
    'most and of the one that faces away most. The 30 ms are four and a half periods of 150 '
    'Hz.'
)


def run_study(request: RowStudyRequest) -> RowStudyResult:
    """Study the link in the room, at dusk and in the sun, with one ADC block per seed."""
    links = {name: measure_link(name, request.seeds) for name in (INDOOR_SCENARIO, DUSK)}
    links[DAYLIGHT_SCENARIO] = measure_link(DAYLIGHT_SCENARIO, request.seeds, FOR_SUN)
    at = {name: find_point(link.at, PAPER_RANGE) for name, link in links.items()}
    values = {
        'lux': MeasuredValue(at[INDOOR_SCENARIO].lux),
        'snr_room': MeasuredValue(at[INDOOR_SCENARIO].snr, seeds=request.seeds),
        'snr_dusk': MeasuredValue(at[DUSK].snr, seeds=request.seeds),
        'snr_sun': MeasuredValue(at[DAYLIGHT_SCENARIO].snr, seeds=request.seeds),
        'range_dusk': MeasuredValue(reception_range(links[DUSK].at), seeds=request.seeds),
        'range_sun': MeasuredValue(
            reception_range(links[DAYLIGHT_SCENARIO].at), seeds=request.seeds
        ),
    }
    trace = simulate_samples()
    values['frequency'] = MeasuredValue(estimate_frequency())
    if not request.quick:
        values['area'] = MeasuredValue(floor_area_per_lamp())
    again = format_lta_command(
        'light', 'link', *(word for name in links for word in ('--scenario', name)),
        *(word for each in LINK_DISTANCES for word in ('--distance', f'{each:g}')),
        '--blocks', str(request.seeds),
    )  # fmt: skip
    curves = list(links.values())
    pictures = [
        StudyPicture('trace', 'What a diode reads', TRACED, plot_diode_samples(trace),
                     format_lta_command('simulate', '--scenario', INDOOR_SCENARIO)),
        StudyPicture('lux', 'Light by distance', LUX_CAPTION, plot_lux(curves), again),
        StudyPicture('snr', 'Signal-to-noise ratio by distance', SNR, plot_snr(curves), again),
    ]  # fmt: skip
    draws = collect_draws(request, partial(measure_draw, request))
    return RowStudyResult(values, pictures, draws=draws)


def measure_link(name: str, blocks: int, changes: Mapping[str, Any] | None = None) -> LampLink:
    """Compute the link budget of a scene."""
    spec = load_spec(LINK_VEHICLE, name, 'bag', '').with_values(changes or {})
    vehicle, scenario, _ = build_vehicle_scenario_stack(spec)
    return compute_lamp_link(vehicle, scenario, LINK_DISTANCES, LINK_ALTITUDE, blocks)


def measure_draw(request: RowStudyRequest, seed: int) -> dict[str, float]:
    """Return light, SNR and range of a draw."""
    changes = request.draw_changes(seed)
    room, dusk = (measure_link(name, 1, changes).at for name in (INDOOR_SCENARIO, DUSK))
    near = find_point(room, PAPER_RANGE)
    return {'lux': near.lux, 'snr_room': near.snr, 'range_dusk': reception_range(dusk)}


def find_point(points: Sequence[LinkPoint], distance: float) -> LinkPoint:
    """Return the point at a distance [m]."""
    return next(each for each in points if math.isclose(each.distance, distance))


def reception_range(points: Sequence[LinkPoint]) -> float:
    """Return the largest distance with an SNR above the demodulator's threshold [m]."""
    needed = DemodulationSettings().threshold
    return max((each.distance for each in points if each.snr >= needed), default=math.nan)


def simulate_samples(distance: float = TRACE) -> np.ndarray:
    """Simulate an ADC block on the lamp's axis in the room, shape (samples, diodes)."""
    scenario = load_scenario(INDOOR_SCENARIO)
    vehicle = load_vehicle(LINK_VEHICLE, scenario.air.density)
    field = scenario.light_field
    x, y, _ = field.first_lamp.position
    # The lamp shines towards -x; the drone faces it with heading 0.
    stand = (x - distance, y, LINK_ALTITUDE, 0.0)
    return simulate_block(field, vehicle, vehicle.diodes, stand, 0)


def estimate_frequency() -> float:
    """Estimate the beacon frequency at the paper's range [Hz]."""
    light, top = (
        load_topic_table().light,
        load_vehicle(LINK_VEHICLE).file.sensors.diodes.largest_reading,
    )
    listener = BeaconReceiver(DemodulationSettings(), light.sample_rate.si, light.samples, top)
    peaks = listener.demodulate_next_block(simulate_samples(PAPER_RANGE)).peaks[0]
    # Of the diode with the best SNR
    return float(peaks.frequency[int(peaks.snr.argmax())])


def floor_area_per_lamp() -> float:
    """Return the floor area per lamp in the shipped warehouse [m2]."""
    # 2.0: required SNR as a multiple of the demodulator's threshold
    plan, ear = load_inputs('warehouse', LINK_VEHICLE, 2.0)
    # 0.5 m cells
    floor = build_floor(plan, ear.vehicle, 0.5)
    layout = plan_layout(plan, ear, floor, list_mounts(plan), 1, None)
    return float(layout.floor.area / len(layout.lamps))


def plot_diode_samples(block: np.ndarray) -> Figure:
    """Plot the first samples of the brightest and the darkest diode."""
    time = 1e3 * np.arange(SHOWN_SAMPLES) / load_topic_table().light.sample_rate.si
    means = block.mean(axis=0)
    curves = [
        Curve(name, time, block[:SHOWN_SAMPLES, index], colour, '%{y} counts', width=1.2)
        for name, index, colour in (
            ('facing the lamp', int(means.argmax()), TRUTH),
            ('facing away', int(means.argmin()), ESTIMATE),
        )
    ]
    axis = ChartAxis('ADC [counts]', zero=True)
    return draw_curves(curves, ChartAxis('time [ms]'), axis)
