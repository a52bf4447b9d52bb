# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the report of a lamp layout."""

from collections.abc import Sequence
import math
from typing import Any, Final

from lta_config.errors import format_count
from lta_report.formatting import MISSING, Tile
from lta_report.report import Block, Picture, Report, TextSection, TextTable
from lta_studies.light.plan.joint_snr import LEAST_PURITY
from lta_studies.light.plan.layout import CoverageGap, find_gaps, LampHandover, LampLayout
from lta_studies.light.plan.pictures import plot_coverage, plot_handovers
from lta_studies.light.plan.request import format_scenario


def encode_layout(layout: LampLayout, handover: LampHandover) -> dict[str, Any]:
    """Return the JSON object of a layout."""
    floor, audible, count = layout.floor, layout.is_received, layout.received_count
    names = [lamp.name for lamp in layout.lamps]
    return {
        'plan': layout.plan.name,
        'vehicle': layout.ear.vehicle.file.name,
        'cell': floor.cell,
        'overlap': layout.overlap,
        'altitude': layout.plan.altitude.si,
        'floor_area': floor.area,
        'wanted_area': float(floor.target_cells.sum()) * floor.cell**2,
        'coverage': layout.coverage,
        'coverage_by_lamps': {
            # Share of the cells that receive at least k lamps
            str(k): float((count >= k).mean())
            for k in range(1, int(count.max(initial=0)) + 1)
        },
        'snr_needed': layout.ear.required_snr,
        'light_needed': layout.least,
        'lamps_at_least': layout.bound,
        'lamps_per_m2': len(names) / floor.area,
        'm2_per_lamp': floor.area / len(names) if names else None,
        'harmonics_clear_up_to': layout.order,
        'lamps': [
            {
                'name': lamp.name,
                'position': list(lamp.mount.position),
                'facing': list(lamp.mount.axis),
                'frequency': lamp.frequency,
                'there_already': bool(lamp.mount.name),
                'heard_area': float(audible[k].sum()) * floor.cell**2,
                'hands_over_to': [names[j] for i, j in handover.edges if i == k],
            }
            for k, lamp in enumerate(layout.lamps)
        ],
        'route': [names[k] for k in handover.route],
        'gaps': [gap._asdict() for gap in find_gaps(layout)],
    }


SCENARIO_FILE: Final = 'scenario.yaml'
PAPER_LAMP_AREA: Final = 150.0  # m2 per lamp, seed paper
MOST_GAPS: Final = 12
PICTURE_HEIGHTS: Final = (360.0, 900.0)  # px of a picture
PLOT_WIDTH: Final = 1100.0  # px, typical width of a plot on a desktop
COVERED: Final = (
    'Colour: SNR of the best received lamp in each cell, at the worst heading of the drone. '
    'Grey: obstacles. White: the hull does not fit. Hatched: fewer lamps are received than '
    'required.'
)
HANDED: Final = (
    'Rings: where a flight to a lamp ends, the nearest cell that receives it. Thin lines: '
    'hand-overs, where the next lamp is received at that point and the straight path to the '
    'end of its flight is free. Thick: the longest of the shortest routes between two lamps.'
)
RECEPTION_METHOD: Final = (
    'A lamp is received in a cell if two conditions hold at every heading with all other '
    'lamps on: its SNR on its best diode is at least {needed:g} ({margin:g} times the '
    'threshold of the demodulator), and in its search window it is {pure:g} times as strong '
    'as the crosstalk of the others. Light, diodes, noise and demodulation are those of the '
    "simulator. Walls, obstacles and the drone's own hull block the light. Neglected are "
    'reflections, which is conservative, tilt, and details smaller than a cell of '
    '{cell:g} m.'
)


def build_report(layout: LampLayout, handover: LampHandover, next_step: str) -> Report:
    """Return the report of a layout; `next_step` is a command."""
    plan, height = layout.plan, picture_height(layout)
    scene = format_scenario(layout, handover)
    return Report(
        command='light plan',
        subject=plan.name,
        headline=format_headline(layout),
        introduction=plan.about,
        tiles=build_tiles(layout, handover),
        blocks=(
            Picture(
                'coverage', 'Coverage at flight altitude', COVERED, plot_coverage(layout),
                height=height,
            ),
            Picture(
                'handover', 'Hand-overs and a route', HANDED, plot_handovers(layout, handover),
                height=height,
            ),
            build_lamp_table(layout, handover),
            build_gap_block(find_gaps(layout)),
            TextSection(
                'Detection criterion, frequencies and simplifications',
                (
                    RECEPTION_METHOD.format(
                        needed=layout.ear.required_snr, margin=layout.ear.margin,
                        pure=LEAST_PURITY,
                        cell=layout.floor.cell,
                    ),
                    describe_separation(layout),
                ),
            ),
        ),
        data=encode_layout(layout, handover),
        facts=build_provenance_table(layout),
        commands={'Fly in it': next_step},
        files={'The scenario file': scene},
        closing=(format_lamp_count(layout),),
        outputs={SCENARIO_FILE: scene},
    )  # fmt: skip


def format_headline(layout: LampLayout) -> str:
    """Return the headline."""
    count, where = len(layout.lamps), layout.plan.name.replace('_', ' ')
    number = 'at least one' if layout.overlap == 1 else f'at least {layout.overlap}'
    return (
        f'{format_count(count, "lamp")}: at any heading, a drone receives {number} '
        f'over {format_percent(layout.coverage)} % of the floor of {where}.'
    )


def format_percent(share: float) -> str:
    """Format a share in percent, rounded down so that 100 means complete."""
    return '100' if share == 1.0 else f'{math.floor(1000.0 * share) / 10.0:g}'


def build_tiles(layout: LampLayout, handover: LampHandover) -> list[Tile]:
    """Return the tiles of the layout."""
    count, floor = len(layout.lamps), layout.floor
    area = float(floor.target_cells.sum()) * floor.cell**2
    # The best lamp in each cell, then the worst cell
    weakest = float(layout.snr.max(axis=0).min())
    two = format_percent(float((layout.received_count >= 2).mean()))
    tones = [lamp.frequency for lamp in layout.lamps]
    steps = len(handover.route)
    return [
        Tile(
            'covered', format_percent(layout.coverage), '%',
            f'of {area:.0f} m² where the hull fits',
        ),
        Tile('lamps', str(count), '', f'at least {layout.bound} for full coverage'),
        Tile(
            'lamps by area', f'{100.0 * count / floor.area:.2f}', 'per 100 m²',
            f'one for {floor.area / max(count, 1):.0f} m²; paper: one for {PAPER_LAMP_AREA:g} m²',
        ),
        Tile('two lamps received', two, '%', 'of the same area, which allows a hand-over'),
        Tile(
            'weakest spot', f'{weakest:.0f}', 'SNR',
            f'{layout.ear.required_snr:g} is required',
        ),
        Tile(
            'frequencies', f'{min(tones):g} to {max(tones):g}', 'Hz',
            f'{len(handover.edges)} hand-overs; the route passes {steps} lamps',
        ),
    ]  # fmt: skip


def picture_height(layout: LampLayout) -> int:
    """Return the height of a plot of the floor on a desktop [px]."""
    corners = layout.plan.outline.corners
    across, up = corners.max(axis=0) - corners.min(axis=0)
    # 60 px for the axis below the plot
    return round(
        min(max(float(up / across) * PLOT_WIDTH + 60.0, PICTURE_HEIGHTS[0]), PICTURE_HEIGHTS[1])
    )


def format_lamp_count(layout: LampLayout) -> str:
    """Return a sentence on the number of lamps and on hand-overs."""
    count, two = len(layout.lamps), float((layout.received_count >= 2).mean())
    return (
        f'{format_count(count, "lamp")} (at least {layout.bound} needed), one per '
        f'{layout.floor.area / count:.0f} m² of floor; two or more lamps are detected on '
        f'{format_percent(two)} % of the floor.'
    )


def build_lamp_table(layout: LampLayout, handover: LampHandover) -> TextTable:
    """Return the table of the lamps, which are numbered from 1 as in the plots."""
    heads = ('lamp', 'x [m]', 'y [m]', 'z [m]', 'frequency [Hz]', 'received over [m²]', 'faces',
             'hands over to')  # fmt: skip
    rows = []
    for k, lamp in enumerate(layout.lamps):
        area = float(layout.is_received[k].sum()) * layout.floor.cell**2
        others = [str(j + 1) for i, j in handover.edges if i == k]
        rows.append([
            f'{k + 1} {lamp.name}', *(f'{part:.1f}' for part in lamp.mount.position),
            f'{lamp.frequency:g}', f'{area:.0f}',
            format_facing(lamp.mount.axis) + (', existing' if lamp.mount.name else ''),
            ', '.join(others) or MISSING,
        ])  # fmt: skip
    return TextTable('Lamps, their frequencies and hand-overs', heads, rows)


def format_facing(axis: tuple[float, float, float]) -> str:
    """Format the direction of a lamp."""
    if abs(axis[2]) > 0.9:
        return 'down' if axis[2] < 0.0 else 'up'
    return f'{math.degrees(math.atan2(axis[1], axis[0])) % 360.0:.0f}°'


def describe_separation(layout: LampLayout) -> str:
    """Describe the separation of the frequencies."""
    ear = layout.ear
    width = ear.light.sample_rate.si / ear.light.samples
    half = ear.demodulation.window * width
    return (
        'Directions are anticlockwise from x. Every frequency is at the centre of a bin of '
        f'{width:g} Hz, more than {2 * half:g} Hz from every other and more than {half:g} Hz '
        f'from every multiple of {layout.plan.ambient.mains_frequency.si:g} Hz (mains). No '
        f'harmonic of a lamp up to the {layout.order}th, aliased by the '
        f'{ear.light.sample_rate.si:g} samples/s, is in the search window of another lamp.'
    )


def build_gap_block(gaps: Sequence[CoverageGap]) -> Block:
    """Return the table of the largest gaps, or a sentence that there are none."""
    if not gaps:
        return TextSection('Gaps', ('None: the whole floor where the hull fits is covered.',))
    rows = [
        [
            str(k), f'{gap.area:.2f}', f'{gap.west:.1f} to {gap.east:.1f}',
            f'{gap.south:.1f} to {gap.north:.1f}', gap.why,
        ]
        for k, gap in enumerate(gaps[:MOST_GAPS], start=1)
    ]  # fmt: skip
    more = len(gaps) - MOST_GAPS
    return TextTable(
        f'Gaps, {sum(gap.area for gap in gaps):.1f} m² in total',
        ('gap', 'area [m²]', 'x [m]', 'y [m]', 'why'),
        rows,
        f'and {more} smaller ones, in plan.json.' if more > 0 else '',
    )


def build_provenance_table(layout: LampLayout) -> dict[str, str]:
    """Return the provenance table of the page."""
    plan, lamp = layout.plan, layout.plan.lamp
    angle = math.degrees(lamp.half_power.si)
    return {
        'vehicle': f'{layout.ear.vehicle.file.name}, hull centre at {plan.altitude.si:g} m',
        'lamps': f'{lamp.flux.si:g} lm, half-power angle {angle:g}°, at {lamp.height.si:g} m, '
        f'facing {lamp.facing}; {layout.places} candidate positions',
        'ambient light': f'{plan.ambient.steady.si:g} lx steady, mains flicker of '
        f'{plan.ambient.mains_amplitude.si:g} lx at {plan.ambient.mains_frequency.si:g} Hz',
        'light needed': f'{layout.least:.2g} lx on the diode, from a single lamp',
        'cells': f'{layout.floor.cell:g} m',
    }
