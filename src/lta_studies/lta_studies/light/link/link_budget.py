# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compute and report illuminance and SNR of a scene's first lamp against distance.

The drone is on the lamp's axis (seen from above) and faces the lamp. The light comes from the link
model. The SNR is the demodulator's median over several ADC blocks with different gains, noise and
heading.
"""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
import math
from typing import Final, final

from lta_config.command_line import format_lta_command
from lta_config.errors import BadInput
from lta_config.topics import load_topic_table
from lta_model.light.direct_light import build_beam, direct_light
from lta_model.light.field import LightField
from lta_model.light.scene_geometry import is_in_room
from lta_model.light.view import build_field_geometry, LightView, Pose
from lta_model.scenario import load_scenario, Scenario
from lta_model.sensors.photodiode import PhotodiodeArray
from lta_model.vehicle import load_vehicle, Vehicle
from lta_report.charts import ChartAxis, Curve, draw_curves, item_colour, Level
from lta_report.formatting import Tile
from lta_report.palette import WALL
from lta_report.report import Picture, Report, TextSection, TextTable
from lta_report.request import Names, option, ReportRequest, StudyRun, VEHICLE
from lta_report.result_table import build_table, Column
from lta_vlc.demodulation import demodulate_beacon, plan_bins
from lta_vlc.settings import DemodulationSettings
import numpy as np
from numpy.typing import NDArray
from plotly.graph_objects import Figure
from rich.progress import track

BLOCK_NS = 100_000_000
LARGEST_HEADING_OFFSET = math.radians(
    22.5
)  # largest heading offset: half the spacing of eight diodes


@final
class LinkRequest(ReportRequest, command='light link'):
    """
    Compute the link budget: illuminance at the photodiodes and SNR, by distance from a lamp.

    The drone is on the axis of the scene's first lamp and faces it. Direct: on a plane that faces
    the lamp. Read: at the brightest diode, with its angular response, room reflections and the
    shadow of the hull. Echo: at the darkest diode. SNR: as the demodulator reports it. In light
    that saturates the diodes there is none; --feedback tries another resistor.

    Exit status 0: done. 2: bad input.

    Example: lta light link --scenario lamp_room --distance 3 --distance 7
    """

    scenario: Names = option(
        'Scenario with a lamp; repeat to compare several.',
        default=('lamp_room', 'sunny_field'), complete='scenario',
    )  # fmt: skip
    vehicle: str = VEHICLE
    distance: tuple[float, ...] = option(
        'Distance from the lamp in metres; repeat to compare several.',
        default=(0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0), low=0.05, high=1000.0,
    )  # fmt: skip
    altitude: float = option(
        'Height of the hull centre in metres.', default=1.3, low=0.05, high=1000.0
    )
    feedback: float | None = option(
        "Feedback resistor of the photodiodes in kohm; default: the vehicle's own.", default=None,
        low=0.001, high=1e6,
    )  # fmt: skip
    blocks: int = option(
        'Number of ADC blocks simulated at each distance.', default=20, low=1, high=1000
    )

    def run(self, run: StudyRun) -> Report:
        """Return the report of all scenes."""
        distances = sorted(set(self.distance))
        # Load all before the first is computed
        scenes = [load_scenario(name) for name in self.scenario]
        links = [
            compute_lamp_link(
                # The density of the scene's air belongs to the vehicle model
                load_vehicle(self.vehicle, each.air.density), each, distances, self.altitude,
                self.blocks, self.feedback,
            )
            for each in track(scenes, 'light link', console=run.console, transient=True)
        ]  # fmt: skip
        return build_report(links, self.vehicle, self.altitude)


@final
@dataclass(frozen=True, slots=True)
class LinkPoint:
    """The link at one distance."""

    distance: float  # horizontal distance from the lamp to the hull centre [m]
    lux: float  # direct light on a plane that faces the lamp, while it is on [lx]
    read: float  # reading of the brightest diode, including its response and reflections [lx]
    echo: float  # reading of the darkest diode: reflections only [lx]
    steady: float  # largest ambient light and daylight on a diode [lx]
    snr: float  # SNR of the best diode, median of the blocks
    clipped: bool  # whether any sample saturates the ADC


@final
@dataclass(frozen=True, slots=True)
class LampLink:
    """Link of one scene by distance, with the feedback resistor of the vehicle [ohm]."""

    scenario: str
    about: str
    feedback: float
    at: tuple[LinkPoint, ...]


def compute_lamp_link(
    vehicle: Vehicle,
    scenario: Scenario,
    distances: Sequence[float],
    altitude: float,
    blocks: int,
    feedback: float | None = None,
) -> LampLink:
    """
    Compute the link of a scene.

    Parameters
    ----------
    vehicle, scenario : Vehicle, Scenario
        Receiver and scene.
    distances : sequence of float
        Distances from the lamp. [m]
    altitude : float
        Height of the hull centre. [m]
    blocks : int
        ADC blocks at each distance.
    feedback : float, optional
        Feedback resistor in place of the vehicle's own. [kohm]

    Raises
    ------
    BadInput
        If no distance is inside the scene, or the lamp shines vertically.

    """
    field = scenario.light_field
    ahead, left, _ = field.first_lamp.direction
    # Horizontal part of the beam's direction
    level = math.hypot(ahead, left)
    if level < 1e-6:
        raise BadInput(
            f'The first lamp of {scenario.name} shines straight up or down, but the link is '
            'computed along a horizontal axis; choose a scenario whose first lamp shines '
            'sideways.'
        )
    diodes, around = vehicle.diodes, build_field_geometry(field)
    if feedback is not None:
        diodes = diodes.model_copy(update={'feedback_resistance': 1e3 * feedback})
    x, y, _ = field.first_lamp.position
    points = []
    for distance in distances:
        place = (x + distance * ahead / level, y + distance * left / level, altitude)
        # A scene with an outside continues beyond its room.
        if scenario.outside is not None or is_in_room(around, *place):
            # The drone looks back along the beam.
            towards = math.atan2(-left, -ahead)
            points.append(
                _compute_link_point(field, vehicle, diodes, distance, (*place, towards), blocks)
            )
    if not points:
        raise BadInput(
            'At all distances from the lamp, the drone would be outside the room of the '
            f'scenario {scenario.name}; choose a shorter --distance or a lower --altitude.'
        )
    return LampLink(scenario.name, scenario.about, diodes.feedback_resistance, tuple(points))


def _compute_link_point(
    field: LightField,
    vehicle: Vehicle,
    diodes: PhotodiodeArray,
    distance: float,
    stand: tuple[float, float, float, float],
    blocks: int,
) -> LinkPoint:
    """Compute the link at a place [m] with the lamp in a direction [rad]."""
    table = load_topic_table()
    rate, samples = table.light.sample_rate.si, table.light.samples
    frequency = field.first_lamp.wave.frequency
    bins = plan_bins(DemodulationSettings(frequency=frequency), rate, samples)
    x, y, z, towards = stand
    facing = LightView(field, vehicle, diodes).compute_diode_readings(
        [_build_level_pose(x, y, z, towards)]
    )
    snr, clipped = [], False
    for seed in range(blocks):
        block = simulate_block(field, vehicle, diodes, stand, seed)
        snr.append(float(demodulate_beacon(block, bins).snr.max()))
        # A sample at full scale
        clipped |= bool((block >= 2**diodes.adc_bits - 1).any())
    return LinkPoint(
        distance=distance,
        lux=direct_light(build_beam(field.first_lamp), (x, y, z - diodes.depth))[0],
        # The brightest diode faces the lamp, the darkest sees reflections only.
        read=float(facing.modulated[0].max()),
        echo=float(facing.modulated[0].min()),
        steady=float(facing.steady.max()),
        snr=float(np.median(snr)),
        clipped=clipped,
    )


def simulate_block(
    field: LightField,
    vehicle: Vehicle,
    diodes: PhotodiodeArray,
    stand: tuple[float, float, float, float],
    seed: int,
) -> NDArray[np.uint16]:
    """Simulate an ADC block at a place [m] facing a direction [rad]; (samples, diodes)."""
    light = load_topic_table().light
    chance = np.random.default_rng(seed)
    x, y, z, towards = stand
    view = LightView(field, vehicle, diodes.draw_gains(chance))
    view.record_pose(
        _build_level_pose(
            x, y, z, towards + LARGEST_HEADING_OFFSET * float(chance.uniform(-1.0, 1.0))
        )
    )
    # Blocks follow each other in time, so each has another phase of the lamp.
    return view.sample_light_block(seed * BLOCK_NS, light.sample_rate.si, light.samples, chance)


def _build_level_pose(x: float, y: float, z: float, heading: float) -> Pose:
    return (x, y, z, 0.0, 0.0, math.sin(0.5 * heading), math.cos(0.5 * heading))


LINK_COLUMNS: Final[tuple[Column[LinkPoint], ...]] = (
    Column('distance', 'distance', 'm'),
    Column('lux', 'direct', 'lx', 1),
    Column('read', 'read', 'lx', 1),
    Column('echo', 'echo', 'lx', 1),
    Column('steady', 'steady', 'lx', 1),
    Column('', 'SNR', of=lambda at: f'{at.snr:.1f}' + (' clipped' if at.clipped else '')),
)
PAPER_DISTANCE: Final = 7.0  # m
PAPER_LUX: Final = (20.0, 90.0)  # range read from "several tens of lux"
NEEDED: Final = 10.0  # required SNR at that distance
LUX_CAPTION: Final = (
    'Solid: light measured by the brightest diode while the lamp is on, including its '
    'angular response and reflections. Dotted: direct light on a plane that faces the lamp. '
    'Grey bar: the "several tens of lux" at 7 m of the paper (Huang et al. 2025).'
)
SNR: Final = (
    'SNR of the best diode after demodulation: median of several blocks of samples with '
    'different gains, noise and heading. Dotted: an SNR of 10.'
)
LINK_METHOD: Final = (
    'The drone is level and faces the lamp within 22.5 degrees. The light falls with the '
    'square of the distance, the surfaces of the scene reflect it, and the hull shades the '
    'diodes below it.'
)
PAPER_NOTE: Final = (
    'For comparison: the seed paper reports several tens of lux at 7 m from the lamp, and a high '
    'SNR.'
)


def build_report(links: Sequence[LampLink], vehicle: str, altitude: float) -> Report:
    """Return the report of a link budget."""
    return Report(
        command='light link',
        subject=vehicle,
        headline=format_headline(links),
        introduction='Illuminance and signal-to-noise ratio of a lamp against the distance from '
        'it.',
        tiles=build_tiles(links),
        blocks=(
            Picture('lux', 'Light on the diodes', LUX_CAPTION, plot_lux(links)),
            Picture('snr', 'Signal-to-noise ratio', SNR, plot_snr(links)),
            *map(build_link_table, links),
            TextSection('Method', (LINK_METHOD,)),
        ),
        data={
            'vehicle': vehicle, 'altitude': altitude, 'links': [asdict(each) for each in links],
        },
        facts={'vehicle': vehicle},
        commands={
            'Fly in the first scenario': format_lta_command(
                'simulate', '--scenario', links[0].scenario
            ),
        },
        closing=(PAPER_NOTE,),
    )  # fmt: skip


def find_reference_point(link: LampLink) -> LinkPoint:
    """Return the point nearest to the paper's distance."""
    return min(link.at, key=lambda at: abs(at.distance - PAPER_DISTANCE))


def format_headline(links: Sequence[LampLink]) -> str:
    """Return the headline."""
    values = [f'{find_reference_point(each).snr:.0f} in {each.scenario}' for each in links]
    distances = {f'{find_reference_point(each).distance:g}' for each in links}
    return f'At {"/".join(sorted(distances))} m the SNR is {", ".join(values)}.'


def build_tiles(links: Sequence[LampLink]) -> list[Tile]:
    """Return tiles with light and SNR of each scene at the paper's distance."""
    tiles = []
    for each in links:
        at = find_reference_point(each)
        note = f'direct light at {at.distance:g} m; paper: several tens of lx'
        tiles.append(Tile(each.scenario, f'{at.lux:.0f}', 'lx', note))
        tiles.append(Tile(each.scenario, f'{at.snr:.0f}', '', f'SNR at {at.distance:g} m'))
    return tiles


def plot_lux(links: Sequence[LampLink]) -> Figure:
    """Plot light against distance."""
    curves = list_curves(links, lambda at: at.read, '%{y:.3g} lx')
    direct = list_curves(links, lambda at: at.lux, '%{y:.3g} lx direct', ', direct')
    curves += [
        replace(each, mode='lines', dash='dot', width=1.2, more={'showlegend': False})
        for each in direct
    ]
    figure = draw_curves(curves, distance_axis(links), ChartAxis('light [lx]', log=True))
    return figure.add_shape(
        type='line', x0=PAPER_DISTANCE, x1=PAPER_DISTANCE, y0=PAPER_LUX[0], y1=PAPER_LUX[1],
        line={'color': WALL, 'width': 8}, layer='below',
    )  # fmt: skip


def plot_snr(links: Sequence[LampLink]) -> Figure:
    """Plot SNR against distance."""
    curves = list_curves(links, lambda at: at.snr, 'SNR %{y:.3g}')
    return draw_curves(
        curves, distance_axis(links), ChartAxis('SNR', log=True), levels=[Level(NEEDED)]
    )


def list_curves(
    links: Sequence[LampLink], figure_of: Callable[[LinkPoint], float], hover: str, words: str = ''
) -> list[Curve]:
    """Return a curve against distance for each scene."""
    return [
        Curve(
            link.scenario + words, [at.distance for at in link.at],
            [figure_of(at) for at in link.at], item_colour(k), hover, 'lines+markers', size=6,
        )
        for k, link in enumerate(links)
    ]  # fmt: skip


def distance_axis(links: Sequence[LampLink]) -> ChartAxis:
    """Return the axis of distances; a small scene has fewer of them."""
    ticks = max(([at.distance for at in link.at] for link in links), key=len)
    return ChartAxis('distance from the lamp [m]', log=True, ticks=ticks)


def build_link_table(link: LampLink) -> TextTable:
    """Return the table of one scene by distance."""
    heading = f'{link.scenario}, feedback resistor of {link.feedback / 1e3:g} kohm'
    return build_table(heading, LINK_COLUMNS, link.at, link.about)
