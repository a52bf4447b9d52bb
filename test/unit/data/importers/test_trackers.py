# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What files of trackers state themselves is used: bodies, units, rates, orders of angles."""

from pathlib import Path

from lta_data.bag.table import stack_components
from lta_data.importers.draft.draft_mapping import draft_mapping
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from .lab_flights import lab_flight
from .test_log_conventions import Array, Flight, import_draft

ROD = [700.0, -250.0, 310.0]  # mm; stands still


def write_vicon(f: Flight, bodies: tuple[str, ...]) -> str:
    """Return axis times angle and places in mm of one or two bodies, the names only above them."""
    place = 1e3 * f['p']
    parts = {'ship': np.hstack([Rotation.from_quat(f['q']).as_rotvec(degrees=True), place]),
             'rod': np.tile([4.0, 5.0, 6.0, *ROD], (len(place), 1))}  # fmt: skip
    head = [
        'Segments' if 'rod' in bodies else 'Objects', '50',
        ',,' + ',,,,,,'.join(f'{body}:{body}' for body in bodies),
        'Frame,Sub Frame' + ',RX,RY,RZ,TX,TY,TZ' * len(bodies),
        ',' + ',deg,deg,deg,mm,mm,mm' * len(bodies),
    ]  # fmt: skip
    rows = np.column_stack([parts[body] for body in bodies])
    return '\n'.join([*head, *(f'{k + 1},0,{join(row, ",")}' for k, row in enumerate(rows))])


def write_qtm(f: Flight, bodies: tuple[str, ...]) -> str:
    """Return places in mm, angles about x, y, z and a matrix by column, named for one column."""
    turn = Rotation.from_quat(f['q'])
    elements = turn.as_matrix().transpose(0, 2, 1).reshape(-1, 9)
    parts = {
        'ship': np.hstack([1e3 * f['p'], turn.as_euler('XYZ', degrees=True), elements]),
        'rod': np.tile([*ROD, 0.0, 0.0, 0.0, *np.eye(3).ravel()], (len(f['t']), 1)),
    }
    names = ['X', 'Y', 'Z', 'Roll', 'Pitch', 'Yaw', *(f'Rot[{k}]' for k in range(9))]
    head = [
        f'NO_OF_FRAMES\t{len(f["t"])}', 'FREQUENCY\t50', 'DATA_INCLUDED\t6D',
        'BODY_NAMES\t' + '\t'.join(bodies),
        '\t'.join(f'{body} ' + '\t'.join(names) for body in bodies),
    ]  # fmt: skip
    rows = np.column_stack([parts[body] for body in bodies])
    return '\n'.join([*head, *(join(row, '\t') for row in rows)])


def join(row: Array, delimiter: str) -> str:
    return delimiter.join(f'{value:.6f}' for value in row)


@pytest.mark.parametrize('bodies', [('ship',), ('rod', 'ship')], ids='-'.join)
@pytest.mark.parametrize('write', [write_vicon, write_qtm])
def test_bodies_units_and_the_rate_are_those_of_the_file(
    write: object, bodies: tuple[str, ...], tmp_path: Path
) -> None:
    f = lab_flight()
    source = tmp_path / 'take.csv'
    assert callable(write)
    source.write_text(write(f, bodies) + '\n')
    draft = draft_mapping(source, {})
    assert draft.choices.questions == []
    assert draft.text.count('- topic:') == 1
    series = import_draft(draft, source, tmp_path)
    np.testing.assert_allclose(np.diff(series.index), 0.02, atol=1e-6)
    np.testing.assert_allclose(stack_components(series, 'pose.pose.position'), f['p'], atol=1e-5)
    attitude = Rotation.from_quat(stack_components(series, 'pose.pose.orientation'))
    apart = attitude.inv() * Rotation.from_quat(f['q'])
    assert np.degrees(apart.magnitude()).max() < 0.01


def test_markers_without_names_above_them_have_those_that_the_file_lists(tmp_path: Path) -> None:
    f = lab_flight()
    head = ['NO_OF_FRAMES\t2', 'FREQUENCY\t50', 'MARKER_NAMES\tship']
    source = tmp_path / 'take.tsv'
    source.write_text('\n'.join([*head, *(join(1e3 * row, '\t') for row in f['p'])]) + '\n')
    text = draft_mapping(source, {}).text
    assert "columns: ['ship X [mm]', 'ship Y [mm]', 'ship Z [mm]'], unit: mm" in text


def test_a_line_of_repeated_names_alone_is_read(tmp_path: Path) -> None:
    f = lab_flight()
    source = tmp_path / 'log.csv'
    lines = ['t,x,y,z,pose,pose', *(join([*row, 0.0, 0.0], ',') for row in
                                     np.column_stack([f['t'], f['p']]))]  # fmt: skip
    source.write_text('\n'.join(lines) + '\n')
    assert 'columns: [x, y, z]' in draft_mapping(source, {}).text
