"""Build the report of a comparison of mounts."""

from collections.abc import Mapping
import math
from typing import Final

from lta_report.charts import ChartAxis, Curve, DASHED, draw_curves
from lta_report.curves import Array
from lta_report.drawing import (
    add_legend,
    build_line_trace,
    create_figure,
    decimate_line,
    EndLabel,
    label_ends,
    padded_range,
)
from lta_report.formatting import Tile
from lta_report.palette import ESTIMATE, GOOD, LAMP, SETPOINT, TRUTH, WALL
from lta_report.report import Picture, Report, TextSection
from lta_studies.energy.mounting.mounted_vehicle import LIGHT_DIRECTIONS
from lta_studies.energy.mounting.run import MountingStudy, MountTrial
from lta_studies.energy.mounting.straight_flight import (
    average_over_seeds,
    FLIGHT_END,
    LIFT_OFF_TIME,
    MOUNTING_DEPARTURE,
    RELEASE_TIME,
)
from lta_studies.energy.mounting.tables import build_comparison_tables, to_json
from lta_vehicle.figures.mass_budget import DEGREES
import numpy as np
from plotly.graph_objects import Bar, Figure
import yaml


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


ANGLE_HOVER: Final = '%{y:.3~f} °'
MOUNT_COLOURS: Final = (ESTIMATE, TRUTH, GOOD, LAMP, SETPOINT)
MOUNTING_ABOUT: Final = (
    'The same solar panels at the side, at the bottom and on top: how their position '
    'affects weight, balance, oscillation, drag and shade.'
)
STRAIGHT_CAPTION: Final = (
    'Pitch (nose up positive) in closed-loop flights with seed 1, all in a hull that '
    'carries every mount. Top: panels in place. Bottom: panels misplaced forward. Dotted: '
    'release by hand, lift-off, and start of the flight at 0.1 m/s.'
)
SWING_CAPTION: Final = (
    'Pitch after a release at 5° in still air with motors off. Dashed: envelope of the '
    'linearised analytical model.'
)
OVERTURNING_CAPTION: Final = (
    'Tilt of the top mount after a release at 5°, with its centre of gravity below, at and '
    'above the centre of buoyancy and all else equal. If both centres coincide, there is no '
    'righting moment.'
)
LIGHT_CAPTION: Final = (
    'Light on the panels, relative to an unshaded plate that faces the light; for the '
    'overcast sky, to a level plate. Full: both panels in series, limited by the darker '
    'one. Pale: each panel separately.'
)
MOUNTING_METHOD: Final = (
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
        headline=format_headline(study),
        introduction=MOUNTING_ABOUT,
        tiles=build_tiles(study),
        blocks=(
            Picture(
                'straight', 'Straight flight at 0.1 m/s', STRAIGHT_CAPTION,
                draw_straight_flights(study)
            ),
            Picture('light', 'Light on the panels', LIGHT_CAPTION, draw_light_shares(study)),
            Picture('swing', 'Swing after a release', SWING_CAPTION, draw_swings(study)),
            Picture(
                'over', 'Centre of gravity below, at and above the hull centre',
                OVERTURNING_CAPTION,
                draw_overturning(study),
            ),
            *build_comparison_tables(study),
            TextSection('Method', MOUNTING_METHOD),
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
    swing, light = pitch_rms(study), mean_light_share(study)
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
        for colour, (name, each) in zip(MOUNT_COLOURS, group.items(), strict=False):
            record = each.flights[0].track.crop(LIFT_OFF_TIME - 4.0, FLIGHT_END)
            degrees = DEGREES * record.pitch
            figure.add_trace(
                build_line_trace(name, record.time, degrees, colour, unit='°', width=1.2), row, 1
            )
            # Mean over the last samples, as the last one is a random phase of the swing
            labels.append(EndLabel(name, float(degrees[-1000:].mean()), colour))
            ends.append(degrees)
        label_ends(figure, labels, padded_range(*ends), row)
        figure.update_yaxes(title_text='pitch [°]', row=row)
        for time in (RELEASE_TIME, LIFT_OFF_TIME, MOUNTING_DEPARTURE):
            figure.add_vline(
                x=time, row=row, col=1, line={'color': WALL, 'width': 1, 'dash': '2px,3px'}
            )
    return figure.update_xaxes(title_text='time [s]', row=2)


def draw_swings(study: MountingStudy) -> Figure:
    """Plot the free swing of each mount and its analytical envelope."""
    curves = []
    for colour, (name, each) in zip(MOUNT_COLOURS, study.shared.items(), strict=False):
        time = each.release.time
        lines = (name, DEGREES * each.release.tilt, 'solid'), (
            f'{name}, by hand', swing_envelope(each, time), DASHED,
        )  # fmt: skip
        curves += [
            Curve(words, *decimate_line(time, tilt), colour, ANGLE_HOVER, 'lines', dash, 1.3,
                  label=name if words == name else None)
            for words, tilt, dash in lines
        ]  # fmt: skip
    return draw_curves(curves, ChartAxis('time [s]'), ChartAxis('pitch [°]', range=(-6.0, 6.0)))


def swing_envelope(each: MountTrial, time: Array) -> Array:
    """Return the analytical envelope of the swing. [deg]"""
    # Without a swing (no righting moment) the envelope is constant.
    ratio, period = each.swing.damping_ratio or 0.0, each.swing.period or math.inf
    first = DEGREES * float(each.release.tilt[0])
    # Small damping: exp(-zeta w t) with w = 2 pi / period
    return first * np.exp(-ratio * 2.0 * math.pi / period * time)


def draw_overturning(study: MountingStudy) -> Figure:
    """Plot the tilt with the centre of gravity below, at and above the hull centre."""
    curves = []
    for colour, each in zip((TRUTH, GOOD, ESTIMATE), study.overturning, strict=True):
        where = 'coincident' if each.height == 0.0 else 'above' if each.height > 0.0 else 'below'
        name = f'{where} ({100 * each.height:+.1f} cm)' if each.height else where
        line = decimate_line(each.release.time, DEGREES * each.release.tilt)
        curves.append(Curve(name, *line, colour, ANGLE_HOVER, width=1.4, label=where))
    return draw_curves(curves, ChartAxis('time [s]'), ChartAxis('tilt [°]'))


def draw_light_shares(study: MountingStudy) -> Figure:
    """Plot the shares of light as bars: in series full, separately pale behind."""
    figure = create_figure()
    names = [light.name for light in LIGHT_DIRECTIONS]
    for colour, (mount, shares) in zip(MOUNT_COLOURS, study.light.items(), strict=False):
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
