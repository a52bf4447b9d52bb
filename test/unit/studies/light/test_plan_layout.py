# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Lamps laid out: known optima, set cover against brute force, gaps, hand-overs, the command."""

from itertools import combinations
import json

from hypothesis import given
from hypothesis import strategies as st
from lta_cli.app import build_app
from lta_config.errors import BadInput
from lta_model.scenario import load_scenario
from lta_studies.light.plan.floor import (
    build_floor,
    distance_to_edges,
    find_polygon_flaw,
    points_in_polygon,
    polygon_edges,
    signed_area,
)
from lta_studies.light.plan.layout import (
    find_gaps,
    find_longest_route,
    INTERFERENCE,
    OUT_OF_REACH,
    plan_handover,
    TOO_FEW_LAMPS,
)
from lta_studies.light.plan.planner import (
    coverage_demand,
    improve_cover,
    list_mounts,
    merge_duplicate_cells,
    select_greedily,
    solve_lower_bound,
)
import numpy as np
import pytest
from typer.testing import CliRunner
import yaml

from .halls import content, ear, hall, laid_out, rectangle

CROSS = {
    'across': rectangle(0.1, 5.5, 11.9, 6.5) | {'height': '5 m'},
    'along': rectangle(5.5, 0.1, 6.5, 11.9) | {'height': '5 m'},
}


def test_an_empty_square_room_takes_one_lamp():
    layout = laid_out(hall())
    assert len(layout.lamps) == layout.bound == 1
    assert layout.coverage == 1.0
    assert find_gaps(layout) == []


def test_four_rooms_take_four_lamps_and_no_three_do():
    layout = laid_out(hall(obstacles=CROSS))
    assert len(layout.lamps) == layout.bound == 4
    assert layout.coverage == 1.0
    corners = {(lamp.mount.position[0] > 6, lamp.mount.position[1] > 6) for lamp in layout.lamps}
    assert len(corners) == 4
    three = laid_out(hall(obstacles=CROSS), most=3)
    assert three.coverage == pytest.approx(0.75)
    (gap,) = find_gaps(three)
    assert gap.area == pytest.approx(len(three.floor.cell_centers) / 4 * 0.25)
    assert gap.why == TOO_FEW_LAMPS
    # Nobody flies through the racks.
    assert plan_handover(layout).edges == ()


def test_two_lamps_each_where_two_are_asked_for():
    layout = laid_out(hall(), overlap=2)
    assert len(layout.lamps) == 2
    # But within 2 m of one that fills the converter, by the inverse square of 10 klm at 2 klx.
    near = np.min(
        [
            np.hypot(*(layout.floor.cell_centers - lamp.mount.position[:2]).T)
            for lamp in layout.lamps
        ],
        axis=0,
    )
    assert layout.received_count[near > 2.0].min() == 2
    assert {gap.why for gap in find_gaps(layout)} <= {INTERFERENCE}
    handover = plan_handover(layout)
    assert handover.edges
    assert set(handover.edges) <= {(0, 1), (1, 0)}
    assert len(handover.route) == 2


def test_lamps_that_are_there_are_kept():
    old = {'position': {'value': [12, 6, 1.67], 'unit': 'm'},
           'facing': {'value': [-2, 0, 0], 'unit': '1'}, 'frequency': '450 Hz'}  # fmt: skip
    layout = laid_out(hall(lamps={'old': old}, obstacles=CROSS))
    lamps = {lamp.name: lamp for lamp in layout.lamps}
    assert lamps['old'].frequency == 450.0
    assert lamps['old'].mount.axis == (-1.0, 0.0, 0.0)
    assert 150.0 not in [lamp.frequency for lamp in layout.lamps]


def test_where_no_lamp_may_hang_is_a_gap():
    # Of two rooms, one may have no lamp.
    wall = {'wall': rectangle(5.5, 0.1, 6.5, 11.9) | {'height': '5 m'}}
    layout = laid_out(hall(obstacles=wall, forbidden={'east': rectangle(6, 0, 12, 12)}))
    assert layout.coverage == pytest.approx(0.5)
    (gap,) = find_gaps(layout)
    assert gap.why == OUT_OF_REACH
    assert gap.west >= 6.5


def test_the_hull_needs_room():
    floor = build_floor(hall(obstacles=CROSS), ear().vehicle, 0.25)
    x, y = floor.cell_centers.T
    assert np.all(np.minimum.reduce([x, y, 12 - x, 12 - y]) >= 0.5)
    assert np.all((np.abs(x - 6) >= 1.0) & (np.abs(y - 6) >= 1.0))
    low = {'bench': rectangle(4, 4, 8, 8) | {'height': '1.5 m'}}
    over = build_floor(hall(obstacles=low), ear().vehicle, 0.25)
    assert over.target_cells[over.locate_cells(np.array([6.0, 6.0]))]
    assert len(over.walls) == 8
    part = build_floor(hall(hear={'west': rectangle(0, 0, 3, 12)}), ear().vehicle, 0.25)
    assert part.cell_centers[:, 0].max() < 3.0
    assert part.free.sum() > part.target_cells.sum()


def test_lamps_hang_on_walls_and_racks_and_face_away_from_them():
    mounts = list_mounts(hall(obstacles={'rack': rectangle(4, 4, 8, 8) | {'height': '3 m'}}))
    assert len(mounts) == 16 + 4
    for mount in mounts:
        x, y = np.array(mount.position[:2]) + 0.1 * np.array(mount.axis[:2])
        assert 0 < x < 12
        assert 0 < y < 12
        assert not (4 < x < 8 and 4 < y < 8)
    low = {'rack': rectangle(4, 4, 8, 8) | {'height': '1 m'}}
    assert len(list_mounts(hall(obstacles=low))) == 16
    down = list_mounts(hall(lamp={'facing': 'down', 'height': '4 m'}))
    assert len(down) == 16
    assert {mount.axis for mount in down} == {(0.0, 0.0, -1.0)}


@given(
    heard=st.lists(st.lists(st.booleans(), min_size=9, max_size=9), min_size=3, max_size=7),
    overlap=st.integers(1, 2),
)
def test_a_cover_covers_and_the_bound_holds_against_brute_force(heard, overlap):
    table = np.array(heard)
    needed = coverage_demand(table, overlap)
    cells, asks = merge_duplicate_cells(table, needed)
    bound = solve_lower_bound(cells, asks, [])
    found = select_greedily(table, needed, [], len(table))
    better = improve_cover(table, needed, found, [], bound, np.random.default_rng(0))
    assert np.all(table[better].sum(axis=0) >= needed)
    best = next(
        size
        for size in range(len(table) + 1)
        for some in combinations(range(len(table)), size)
        if np.all(table[list(some)].sum(axis=0) >= needed)
    )
    assert bound <= best <= len(better) <= len(found)


def test_a_greedy_choice_that_is_too_large_is_mended():
    # The greedy choice takes the 8 in the middle first, and then needs both rows.
    rows = np.zeros((3, 14), dtype=bool)
    rows[0, :7] = rows[1, 7:] = True
    rows[2, [0, 1, 2, 3, 7, 8, 9, 10]] = True
    needed = coverage_demand(rows, 1)
    first = select_greedily(rows, needed, [], 3)
    assert sorted(first) == [0, 1, 2]
    assert sorted(improve_cover(rows, needed, first, [], 2, np.random.default_rng(0))) == [0, 1]
    assert 2 in improve_cover(rows, needed, first, [2], 2, np.random.default_rng(0))


def test_the_longest_of_the_shortest_ways():
    assert find_longest_route(4, [(0, 1), (1, 2), (2, 3), (0, 3)]) == (0, 1, 2)
    assert find_longest_route(3, []) == (0,)


def test_polygons_by_hand():
    shape = np.array([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]], dtype=float)
    assert signed_area(shape) == 6.0
    assert signed_area(shape[::-1]) == -6.0
    points = np.array([[0.5, 2.0], [2.0, 2.0], [3.0, 0.5], [-1.0, 0.5]])
    assert points_in_polygon(points, shape).tolist() == [True, False, True, False]
    assert distance_to_edges(points, polygon_edges(shape)) == pytest.approx([0.5, 1.0, 0.5, 1.0])
    assert find_polygon_flaw(shape) is None


@pytest.mark.parametrize(
    ('changes', 'asked', 'words'),
    [
        ({'altitude': '0.3 m'}, {}, 'when it stands on the floor; increase the altitude'),
        ({'altitude': '4.9 m'}, {}, r'reaches 0\.30 m above its hull centre'),
        ({'obstacles': {'all': rectangle(0.2, 0.2, 11.8, 11.8) | {'height': '3 m'}}}, {},
         'fits nowhere in the required area'),
        ({}, {'cell': 0.01}, 'choose larger ones with --cell'),
        ({'forbidden': {'all': rectangle(-1, -1, 13, 13)}}, {}, 'has no position for a lamp'),
        ({'lamp': {'facing': 'down', 'height': '4.5 m', 'flux': '1 lm'}}, {},
         'receives no lamp of'),
        ({'lamp': {'spacing': '0.25 m', 'facing': 'down', 'height': '4 m'},
          'outline': rectangle(0, 0, 120, 12)}, {}, r'increase lamp\.spacing'),
    ],
)  # fmt: skip
def test_a_plan_that_cannot_work_is_one_sentence(changes, asked, words):
    with pytest.raises(BadInput, match=words):
        laid_out(hall(**changes), **asked)


def call(*words):
    return CliRunner().invoke(build_app(), ['light', 'plan', *map(str, words)])


def test_the_command_writes_page_numbers_and_scenario(tmp_path):
    file = tmp_path / 'test.yaml'
    file.write_text(yaml.safe_dump(content(obstacles=CROSS)))
    told = call(file, '--out', tmp_path / 'out')
    assert told.exit_code == 0, told.output
    assert (
        '4 lamps: at any heading, a drone receives at least one over 100 % of the floor of test.'
        in ' '.join(told.stdout.split())
    )
    results = json.loads((tmp_path / 'out/plan.json').read_text())
    assert results['coverage'] == 1.0
    assert results['lamps_at_least'] == 4
    assert results['m2_per_lamp'] == 36.0
    assert len({lamp['frequency'] for lamp in results['lamps']}) == 4
    page = (tmp_path / 'out/report.html').read_text()
    assert '$' not in page.split('<main ')[1].split('</main>')[0].split('<script')[0]
    for words in (
        'Coverage at flight altitude',
        'Hand-overs and a route',
        'None: the whole floor',
    ):
        assert words in page
    scene = load_scenario(str(tmp_path / 'out/scenario.yaml'))
    assert scene.beacons == tuple((lamp['name'], lamp['frequency']) for lamp in results['lamps'])
    assert list(scene.route) == results['route']
    for lamp, shining in zip(results['lamps'], scene.light_field.lamps, strict=True):
        x, y, z = lamp['position']
        assert shining.position == pytest.approx((x - 6, y - 6, z))
        assert shining.direction == pytest.approx(tuple(lamp['facing']))
        assert shining.order == pytest.approx(1.0)
    file.write_text(file.read_text() + '\n# changed only here\n')
    assert call(file, '--out', tmp_path / 'out').exit_code == 0  # the same hall goes on there
    assert isinstance(call('warehouse', '--out', tmp_path / 'out').exception, BadInput)
    printed = call(file, '--out', tmp_path / 'json', '--json')
    page = str(tmp_path / 'json' / 'report.html')
    assert json.loads(printed.stdout) == {**results, 'page': page}


def test_more_lamps_there_than_asked_for_is_bad_input(tmp_path):
    old = {'position': {'value': [12, 6, 1.67], 'unit': 'm'},
           'facing': {'value': [-2, 0, 0], 'unit': '1'}}  # fmt: skip
    file = tmp_path / 'test.yaml'
    file.write_text(yaml.safe_dump(content(lamps={'a': old, 'b': old})))
    told = call(file, '--lamps', 1, '--out', tmp_path / 'out')
    assert 'already has 2 lamps, more than --lamps 1' in str(told.exception)
    assert not (tmp_path / 'out').exists()


def test_more_lamps_than_frequencies_says_how_many_fit(tmp_path):
    told = call('warehouse', '--overlap', '3', '--cell', '1', '--out', tmp_path / 'out')
    assert isinstance(told.exception, BadInput)
    assert 'lamps need a frequency, but only' in str(told.exception)
    assert not (tmp_path / 'out/report.html').exists()
