"""The light link: a raw trace, lux and SNR by distance, and how much floor one lamp serves."""

from collections.abc import Sequence
import math
from typing import Final

from lta_config.topics import topic_table
from lta_config.typed import typed
from lta_model.light.setting import set_for
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_report.drawing import blank
from lta_report.palette import ESTIMATE, RAW, TRUTH
from lta_studies.light.link.measured import At, block_of, Link, link_of
from lta_studies.light.link.page import LUX, lux_picture, SNR, snr_picture
from lta_studies.light.plan.floor import floor_of
from lta_studies.light.plan.given import given
from lta_studies.light.plan.laying import lay_out
from lta_studies.light.plan.mounts import mounts_of
from lta_studies.reproduce.found import Asked, Found, Picture, Value
from lta_vlc.listener import Listener
from lta_vlc.settings import Demodulation
import numpy as np
from plotly.graph_objects import Figure, Scatter

VEHICLE: Final = 'gtmab'
ROOM, DUSK, SUN = 'lamp_room', 'open_field', 'sunny_field'
DISTANCES: Final = (1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0)  # m
RANGE: Final = 7.0  # m, seed paper
ALTITUDE: Final = 1.3  # of the hull centre: diodes at the height of the lamp [m]
TRACE: Final = 3.0  # m
SHOWN: Final = 300  # samples, 30 ms
TRACED: Final = (
    'Counts of the converter at 10 kS/s, 3 m from the lamp in the shared room: the diode that '
    'faces it most, and the one that looks away most. 30 ms, four and a half periods of 150 Hz.'
)


def study(asked: Asked) -> Found:
    """Return the link in the room, at dusk and in the sun; seeds are ADC blocks at each place."""
    links = {name: measured(name, asked.seeds) for name in (ROOM, DUSK, SUN)}
    at = {name: where(link.at, RANGE) for name, link in links.items()}
    values = {
        'lux': Value(at[ROOM].lux),
        'snr_room': Value(at[ROOM].snr, seeds=asked.seeds),
        'snr_dusk': Value(at[DUSK].snr, seeds=asked.seeds),
        'snr_sun': Value(at[SUN].snr, seeds=asked.seeds),
        'range_dusk': Value(heard(links[DUSK].at), seeds=asked.seeds),
        'range_sun': Value(heard(links[SUN].at), seeds=asked.seeds),
    }
    trace = samples()
    values['frequency'] = Value(frequency())
    if not asked.quick:
        values['area'] = Value(area())
    again = typed(
        'light', 'link', *(word for name in links for word in ('--scenario', name)),
        *(word for each in DISTANCES for word in ('--distance', f'{each:g}')),
        '--blocks', str(asked.seeds),
    )  # fmt: skip
    drawn = list(links.values())
    pictures = [
        Picture('trace', 'What a diode reads', TRACED, traced(trace),
                typed('simulate', '--scenario', ROOM)),
        Picture('lux', 'Light by distance', LUX, lux_picture(drawn), again),
        Picture('snr', 'Signal-to-noise ratio by distance', SNR, snr_picture(drawn), again),
    ]  # fmt: skip
    return Found(values, pictures)


def measured(name: str, blocks: int) -> Link:
    """Return the link of a scene."""
    scenario = load_scenario(name)
    vehicle = load_vehicle(VEHICLE, scenario.air.density)
    return link_of(vehicle, scenario, DISTANCES, ALTITUDE, blocks)


def where(found: Sequence[At], distance: float) -> At:
    """Return the link at a distance. [m]"""
    return next(each for each in found if math.isclose(each.distance, distance))


def heard(found: Sequence[At]) -> float:
    """Return the farthest distance at which the SNR passes the demodulator's threshold. [m]"""
    needed = Demodulation().threshold
    return max((each.distance for each in found if each.snr >= needed), default=math.nan)


def samples(distance: float = TRACE) -> np.ndarray:
    """Return an ADC block on the lamp's axis in the room, shape (samples, diodes)."""
    scenario = load_scenario(ROOM)
    vehicle = load_vehicle(VEHICLE, scenario.air.density)
    field = scenario.light_field
    x, y, _ = field.lamp.position
    stand = (x - distance, y, ALTITUDE, 0.0)
    return block_of(field, vehicle, set_for(field, vehicle), stand, 0)


def frequency() -> float:
    """Return the frequency that is found at the paper's range. [Hz]"""
    light, top = topic_table().light, load_vehicle(VEHICLE).file.sensors.diodes.top
    listener = Listener(Demodulation(), light.sample_rate.si, light.samples, top)
    peaks = listener.hear(samples(RANGE)).peaks[0]
    return float(peaks.frequency[int(peaks.snr.argmax())])


def area() -> float:
    """Return how much floor a lamp serves in the shipped warehouse. [m2]"""
    plan, ear = given('warehouse', VEHICLE, 2.0, ())
    floor = floor_of(plan, ear.vehicle, 0.5)
    found = lay_out(plan, ear, floor, mounts_of(plan), 1, None, lambda: None, lambda _: None)
    return float(found.floor.area / len(found.lamps))


def traced(block: np.ndarray) -> Figure:
    """Return the first samples of the brightest and of the darkest diode."""
    figure = blank()
    time = 1e3 * np.arange(SHOWN) / topic_table().light.sample_rate.si
    means = block.mean(axis=0)
    for name, index, colour in (
        ('facing the lamp', int(means.argmax()), TRUTH),
        ('looking away', int(means.argmin()), ESTIMATE),
    ):
        figure.add_trace(
            Scatter(
                x=time, y=block[:SHOWN, index], mode='lines', name=name,
                line={'color': colour, 'width': 1.2}, hovertemplate='%{y} counts',
            )
        )  # fmt: skip
    figure.add_hline(y=0, line={'color': RAW, 'width': 1})
    figure.update_xaxes(title_text='time [ms]')
    figure.update_yaxes(title_text='converter [counts]')
    return figure.update_layout(showlegend=True, legend={'orientation': 'h', 'y': 1.08})
