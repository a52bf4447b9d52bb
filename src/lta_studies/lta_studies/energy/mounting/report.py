"""Build the report of a comparison of mounts."""

from collections.abc import Mapping
import math
from typing import Final

from lta_report.curves import Array
from lta_report.drawing import (
    add_legend,
    build_line_trace,
    create_figure,
    EndLabel,
    label_ends,
    padded_range,
)
from lta_report.formatting import Tile
from lta_report.palette import ESTIMATE, GOOD, LAMP, SETPOINT, TRUTH, WALL
from lta_report.report import Picture, Report, TextSection
from lta_studies.energy.mounting import verdict
from lta_studies.energy.mounting.panel_light import LIGHTS
from lta_studies.energy.mounting.run import MountingStudy, MountTrial
from lta_studies.energy.mounting.straight_flight import AWAY, END, HELD, LIFT_OFF
from lta_studies.energy.mounting.tables import build_comparison_tables, to_json
from lta_vehicle.figures.mass_budget import DEGREES
import numpy as np
from plotly.graph_objects import Bar, Figure
import yaml

COLOURS: Final = (ESTIMATE, TRUTH, GOOD, LAMP, SETPOINT)
ABOUT: Final = (
    'The same solar panels at the side, at the bottom and on top: how their position '
    'affects weight, balance, oscillation, drag and shade.'
)
STRAIGHT: Final = (
    'Pitch (nose up positive) in closed-loop flights with seed 1, all in a hull that '
    'carries every mount. Top: panels in place. Bottom: panels misplaced forward. Dotted: '
    'release by hand, lift-off, and start of the flight at 0.1 m/s.'
)
SWUNG: Final = (
    'Pitch after a release at 5° in still air with motors off. Dashed: envelope of the '
    'linearised analytical model.'
)
OVER: Final = (
    'Tilt of the top mount after a release at 5°, with its centre of gravity below, at and '
    'above the centre of buoyancy and all else equal. If both centres coincide, there is no '
    'righting moment.'
)
SHINE: Final = (
    'Light on the panels, relative to an unshaded plate that faces the light; for the '
    'overcast sky, to a level plate. Full: both panels in series, limited by the darker '
    'one. Pale: each panel separately.'
)
METHOD: Final = (
    'Each mount is a file in config/mounts; its parts replace a layer of the vehicle. "By '
    'hand" is the analytical model: righting moment, inertia with added mass, rotational '
    'drag linearised at 5°. "Simulated" is the 6-DoF model. The controller has no rotor for '
    'pitch: it can only avoid exciting pitch, and its forward rotors add damping.',
    'Neglected: the jets of the upward rotors on the arms of the bottom mount, the flow '
    "around panels on the hull, and the effect of the drone's tilt on the light.",
)


def build_report(study: MountingStudy, commands: Mapping[str, str]) -> Report:
    """Return the report of a comparison of mounts; `commands` are the next steps."""
    return Report(
        command='energy mounting',
        subject=study.vehicle,
        headline=verdict.format_headline(study),
        introduction=ABOUT,
        tiles=build_tiles(study),
        blocks=(
            Picture(
                'straight', 'Straight flight at 0.1 m/s', STRAIGHT, draw_straight_flights(study)
            ),
            Picture('light', 'Light on the panels', SHINE, draw_light_shares(study)),
            Picture('swing', 'Swing after a release', SWUNG, draw_swings(study)),
            Picture(
                'over', 'Centre of gravity below, at and above the hull centre', OVER,
                draw_overturning(study),
            ),
            *build_comparison_tables(study),
            TextSection('Findings', verdict.format_findings(study), printed=True),
            TextSection('Method', METHOD),
        ),
        data=to_json(study),
        facts={'vehicle': study.vehicle},
        commands=commands,
        outputs=format_vehicle_files(study),
    )  # fmt: skip


def format_vehicle_files(study: MountingStudy) -> dict[str, str]:
    """Return a vehicle file for each variant: in the vehicle's hull if that carries a mount."""
    return {
        f'{each.fitted.mount.name}.yaml': yaml.safe_dump(
            dict(each.fitted.content), sort_keys=False
        )
        for each in (study.own or study.shared).values()
    }


def build_tiles(study: MountingStudy) -> list[Tile]:
    """Return tiles with pitch and light of each mount."""
    tiles = []
    swing, light = verdict.pitch_rms(study), verdict.mean_light_share(study)
    for name in study.shared:
        short = 1e3 * study.lacking[name]
        carried = f'{short:.1f} g too heavy' if short > 0.0 else f'{-short:.1f} g to spare'
        tiles.append(Tile(name, f'{DEGREES * swing[name]:.3f}', '° rms', 'of pitch at 0.1 m/s'))
        tiles.append(Tile(name, f'{100 * light[name]:.0f}', '% of light', carried))
    return tiles


def draw_straight_flights(study: MountingStudy) -> Figure:
    """Plot pitch over time, with panels in place and misplaced."""
    figure = create_figure(2, (0.5, 0.5))
    for row, group in enumerate((study.shared, study.misplaced), start=1):
        ends, labels = [], []
        for colour, (name, each) in zip(COLOURS, group.items(), strict=False):
            record = each.flights[0].track.crop(LIFT_OFF - 4.0, END)
            degrees = DEGREES * record.pitch
            figure.add_trace(
                build_line_trace(name, record.time, degrees, colour, unit='°', width=1.2), row, 1
            )
            # Mean over the last samples, as the last one is a random phase of the swing
            labels.append(EndLabel(name, float(degrees[-1000:].mean()), colour))
            ends.append(degrees)
        label_ends(figure, labels, padded_range(*ends), row)
        figure.update_yaxes(title_text='pitch [°]', row=row)
        for time in (HELD, LIFT_OFF, AWAY):
            figure.add_vline(
                x=time, row=row, col=1, line={'color': WALL, 'width': 1, 'dash': '2px,3px'}
            )
    return figure.update_xaxes(title_text='time [s]', row=2)


def draw_swings(study: MountingStudy) -> Figure:
    """Plot the free swing of each mount and its analytical envelope."""
    figure = create_figure()
    labels = []
    for colour, (name, each) in zip(COLOURS, study.shared.items(), strict=False):
        time, tilt = each.release.time, DEGREES * each.release.tilt
        figure.add_trace(build_line_trace(name, time, tilt, colour, unit='°', width=1.3))
        figure.add_trace(
            build_line_trace(
                f'{name}, by hand',
                time,
                swing_envelope(each, time),
                colour,
                unit='°',
                dash='4px,3px',
            )
        )
        labels.append(EndLabel(name, float(tilt[-1]), colour))
    label_ends(figure, labels, (-6.0, 6.0))
    figure.update_xaxes(title_text='time [s]')
    return figure.update_yaxes(title_text='pitch [°]')


def swing_envelope(each: MountTrial, time: Array) -> Array:
    """Return the analytical envelope of the swing. [deg]"""
    # Without a swing (no righting moment) the envelope is constant.
    ratio, period = each.swing.damping_ratio or 0.0, each.swing.period or math.inf
    first = DEGREES * float(each.release.tilt[0])
    # Small damping: exp(-zeta w t) with w = 2 pi / period
    return first * np.exp(-ratio * 2.0 * math.pi / period * time)


def draw_overturning(study: MountingStudy) -> Figure:
    """Plot the tilt with the centre of gravity below, at and above the hull centre."""
    figure = create_figure()
    labels = []
    for colour, each in zip((TRUTH, GOOD, ESTIMATE), study.overturning, strict=True):
        where = 'coincident' if each.height == 0.0 else 'above' if each.height > 0.0 else 'below'
        name = f'{where} ({100 * each.height:+.1f} cm)' if each.height else where
        tilt = DEGREES * each.release.tilt
        figure.add_trace(
            build_line_trace(name, each.release.time, tilt, colour, unit='°', width=1.4)
        )
        labels.append(EndLabel(where, float(tilt[-1]), colour))
    lines = [DEGREES * each.release.tilt for each in study.overturning]
    label_ends(figure, labels, padded_range(*lines))
    figure.update_xaxes(title_text='time [s]')
    return figure.update_yaxes(title_text='tilt [°]')


def draw_light_shares(study: MountingStudy) -> Figure:
    """Plot the shares of light as bars: in series full, separately pale behind."""
    figure = create_figure()
    names = [light.name for light in LIGHTS]
    for colour, (mount, shares) in zip(COLOURS, study.light.items(), strict=False):
        for key, opacity in (('apart', 0.35), ('series', 1.0)):
            figure.add_trace(
                Bar(
                    x=names, y=[100.0 * getattr(shares[name], key) for name in names],
                    name=mount, offsetgroup=mount, opacity=opacity,
                    marker={'color': colour}, showlegend=key == 'series',
                    hovertemplate='%{y:.0f} %',
                )
            )  # fmt: skip
    add_legend(figure).update_layout(barmode='group', bargap=0.3)
    # A word a line, for a narrow window
    figure.update_xaxes(tickvals=names, ticktext=[name.replace(' ', '<br>') for name in names])
    return figure.update_yaxes(title_text='share of light [%]')
