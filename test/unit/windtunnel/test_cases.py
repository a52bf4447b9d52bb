# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Cases on disk: named by content, gone on with, and failures in words. No OpenFOAM."""

from concurrent.futures import ThreadPoolExecutor
import math
import re
import shutil

from lta_config.errors import BadInput
from lta_config.schema.mount_file import load_mount
from lta_windtunnel import reduce
from lta_windtunnel.flow_plan import plan_flows, TRANSIENT_LENGTHS
from lta_windtunnel.openfoam.case import (
    CaseFailed,
    CaseRunner,
    explain_failure,
    FoamCase,
    ProgramStep,
    require_openfoam,
)
from lta_windtunnel.openfoam.input_files import format_files
from lta_windtunnel.openfoam.mesh import BASE_CUBE
from lta_windtunnel.openfoam.output_reader import read_forces, read_mesh, read_table
from lta_windtunnel.solve import check_memory
from lta_windtunnel.tunnel import (
    build_steady_wind_case,
    build_transient_wind_case,
    INCIDENCES,
    PREVIEW,
)
from lta_windtunnel.tunnel_model import load_tunnel_model
import pytest

AIR = (1.2, 1.5e-5)
SAYS = 'Time = 1\nGAMG:  Solving for p, Initial residual = 0.5, Final\nTime = 2\n'


def build_case(*scripts, name='case'):
    steps = [
        ProgramStep(f'{k}', ('sh', '-c', script), {'system/controlDict': f'{k}'}, 2)
        for k, script in enumerate(scripts)
    ]
    return FoamCase(name, {'constant/word': 'a'}, steps, FoamCase('mesh', {}, []))


def test_entries_become_the_text_that_openfoam_reads():
    entries = {'a': 1.5e-5, 'b': [1, [2, 3]], 'c': {'d': True, 'e': ['f', {'g': 1}]}}
    text = format_files({'system/x': entries})['system/x']
    assert 'object      x;' in text
    body = text[text.index('}') + 1 :].split()
    assert body == [
        'a',
        '1.5e-05;',
        'b',
        '(1',
        '(2',
        '3));',
        'c',
        '{',
        'd',
        'true;',
        'e',
        '(f',
        '{',
        'g',
        '1;',
        '});',
        '}',
    ]


def test_a_case_is_named_by_what_it_is():
    assert build_case('true').key == build_case('true', name='other').key
    assert build_case('true').key != build_case('false').key


def test_a_speed_changes_the_flow_and_not_its_mesh():
    model = load_tunnel_model('gtmab')
    cold, warm = (
        plan_flows(model, 'preview', (1.2, nu), ('heave',))[0].case for nu in (1.4e-5, 1.5e-5)
    )
    assert cold.key != warm.key
    assert cold.mesh.key == warm.mesh.key


def test_the_air_of_a_transient_brings_no_eddies_and_begins_with_some():
    eddies, _ = plan_flows(load_tunnel_model('gtmab'), 'reference', AIR, ['heave'])
    words = eddies.case.files['0/nuTilda'].replace(';', '').split()
    begins = float(words[words.index('internalField') + 2])
    comes = float(words[words.index('inlet') + 6])
    assert begins == pytest.approx(5.0 * 1.5e-5)
    assert comes < 1e-6 * 1.5e-5


def test_eddies_are_modelled_beyond_a_reynolds_number():
    """GT-MAB's hull is below 1e5 at 1 m/s, Skye's of 2.7 m beyond."""
    for name, model in (('gtmab', 'laminar;'), ('skye', 'SpalartAllmarasDDES')):
        eddies, slow = plan_flows(load_tunnel_model(name), 'reference', AIR, ['surge'])
        settle, *later = eddies.case.steps
        assert 'SpalartAllmaras;' in settle.files['constant/turbulenceProperties']
        assert all(model in step.files['constant/turbulenceProperties'] for step in later)
        trails = 'trail' in eddies.case.mesh.files['system/snappyHexMeshDict']
        assert trails == (name == 'skye')
        assert (eddies.kind, *eddies.speeds) == ('transient', 1.0)
        assert (slow.kind, *slow.speeds) == ('wind', 0.2)


def test_every_flow_of_a_vehicle_is_planned_once():
    found = plan_flows(load_tunnel_model('gtmab'), 'preview', AIR)
    names = [flow.about for flow in found]
    assert names[:6] == ['heave', 'surge', 'sway', 'roll', 'pitch', 'yaw']
    assert not INCIDENCES.keys() & set(names)
    assert {'up_left', 'up_left_reversed', 'forward_left', 'forward_left_reversed'} < set(names)
    assert 'up_right' not in names  # by symmetry
    assert len({flow.case.key for flow in found}) == len(found)
    # Three winds, each on a coarser mesh too, and one of still air.
    assert len({flow.case.mesh.key for flow in found}) == 7


def test_what_is_done_is_not_done_again(tmp_path):
    told = []
    stages = CaseRunner(tmp_path, lambda *each: told.append(each))
    one = build_case(f'printf "{SAYS}"', 'echo x >> count')
    place = stages.solve(one)
    stages.solve(one)
    assert (place / 'count').read_text() == 'x\n'
    assert stages.is_done(one)
    assert [share for _, step, share, _ in told if step.name == '0'] == [0.5, 1.0, 1.0]


def test_two_runs_on_one_cache_solve_a_case_once(tmp_path):
    one = build_case('sleep 0.2; echo x >> count')
    alone = [CaseRunner(tmp_path, lambda *_: None) for _ in range(2)]
    with ThreadPoolExecutor(2) as pool:
        first, second = pool.map(lambda stages: stages.solve(one), alone)
    assert first == second
    assert (first / 'count').read_text() == 'x\n'


def test_a_run_goes_on_where_it_failed(tmp_path):
    stages = CaseRunner(tmp_path, lambda *_: None)
    one = build_case('echo x >> count', 'test -e mended')
    with pytest.raises(CaseFailed, match='sh failed with exit status 1'):
        stages.solve(one)
    (stages.case_folder(one) / 'mended').touch()
    stages.solve(one)
    assert (stages.case_folder(one) / 'count').read_text() == 'x\n'


def test_half_a_mesh_is_begun_again(tmp_path):
    stages = CaseRunner(tmp_path, lambda *_: None)
    steps = [
        ProgramStep('block', ('sh', '-c', 'mkdir mesh')),
        ProgramStep('snappy', ('sh', '-c', 'touch mesh/refined; test -e ../mended')),
    ]
    mesh = FoamCase('mesh', {}, steps)
    with pytest.raises(CaseFailed):
        stages.solve(mesh)
    (tmp_path / 'mended').touch()
    stages.solve(mesh)  # blockMesh first: refining half a refined mesh fails
    assert stages.is_done(mesh)


@pytest.mark.parametrize(
    ('code', 'tail', 'said'),
    [
        (-8, [], 'diverged'),
        (1, ['#1 Foam::sigFpe::sigHandler(int)'], 'diverged'),
        (-9, [], 'ran out of memory'),
        (-15, ['Time = 3'], 'was killed by signal 15; start again to resume.'),
        (1, ['std::bad_alloc'], 'ran out of memory'),
        (1, ['write failed: No space left on device'], 'disk is full'),
        (1, ['--> FOAM FATAL ERROR: ', 'cannot find file "p"', '', 'FOAM exiting'], 'cannot find'),
        (-6, ['--> FOAM FATAL ERROR: ', 'cell 3 has no points', 'FOAM aborting'], 'cell 3 has no'),
    ],
)
def test_what_went_wrong_is_said(code, tail, said):
    assert said in str(explain_failure('simpleFoam', code, tail))


def test_without_openfoam_one_sentence_says_how_to_get_it(monkeypatch):
    monkeypatch.setattr(shutil, 'which', lambda _: None)
    with pytest.raises(BadInput, match=r'apt-get install .*openfoam.*--fidelity analytic'):
        require_openfoam()


def test_a_mesh_beyond_the_memory_is_refused_before_any_work():
    found = plan_flows(load_tunnel_model('gtmab'), 'preview', AIR, ('surge',))
    with pytest.raises(BadInput, match=r'need about 0\.7 GB of memory, but only 0\.5 GB'):
        check_memory(found, 2, 0.5e9)


FORCE = """# Force
# Time          \t(total_x total_y total_z)\t(pressure_x ...)\t(viscous_x ...)
299 \t(5.4e-02 4.8e-02 4.8e-02)\t(5.2e-02 4.6e-02 4.6e-02)\t(2.0e-03 2.0e-03 2.0e-03)
300 \t(5.44575090e-02 4.87e-02 4.87e-02)\t(5.248e-02 4.67e-02 4.67e-02)\t(1.976e-03 0 0)
"""


def test_forces_are_read_as_they_are_written(tmp_path):
    place = tmp_path / 'postProcessing/forces_envelope/0'
    place.mkdir(parents=True)
    for name in ('force', 'moment'):
        (place / f'{name}.dat').write_text(FORCE)
    read = read_forces(tmp_path, 'envelope', '0')
    assert read.time.tolist() == [299, 300]
    assert read.force[-1].tolist() == [0.054457509, 0.0487, 0.0487]
    assert read.viscous[-1, 0] == 1.976e-3


def test_a_row_cut_short_is_left_out(tmp_path):
    (tmp_path / 'force.dat').write_text(FORCE + '301 \t(5.4e-02 4.8')
    assert read_table(tmp_path / 'force.dat').shape == (2, 10)


def test_a_mesh_tells_its_cells_and_zones(tmp_path):
    (tmp_path / 'log.check').write_text(
        '    cells:            44936\n    Mesh non-orthogonality Max: 42.354442 average: 5.1\n'
        '    Max skewness = 3.0271763 OK.\n'
    )
    (tmp_path / 'log.zones').write_text('    cellZoneSet up_left now size 59\n')
    facts = read_mesh(tmp_path)
    assert (facts.cells, facts.zones) == (44936, {'up_left': 59})
    reduce.check_mesh('mesh', facts)


# As checkMesh 1912 writes it: of a mesh that is sound, and of one whose cells are pulled through
# each other (their angles left out, which are refused by themselves).
SOUND = """    cells:            51632
    Min volume = 2.2610714e-07. Max volume = 0.015977826.  Total volume = 191.86923.  \
Cell volumes OK.
    Mesh non-orthogonality Max: 37.8187 average: 7.9676669
"""
INSIDE_OUT = """    cells:            51632
 ***Zero or negative cell volume detected.  Minimum negative volume: -3.70074e-17, \
Number of negative volume cells: 2
  <<Writing 2 zero volume cells to set zeroVolumeCells
    Mesh non-orthogonality Max: 37.8187 average: 7.9676669
"""


@pytest.mark.parametrize(
    ('check', 'said'),
    [
        (INSIDE_OUT, 'has 2 cells of negative volume'),
        (SOUND.replace('37.8187', '80.2'), 'non-orthogonality of 80 degrees'),
        (SOUND.replace('37.8187', 'nan'), 'non-orthogonality of nan degrees'),
        (SOUND.replace('51632', '12'), 'has too few cells'),
        ('--> FOAM FATAL ERROR: cannot find file "points"\n', 'has too few cells'),
    ],
)
def test_a_mesh_that_is_none_is_refused(tmp_path, check, said):
    (tmp_path / 'log.check').write_text(SOUND)
    reduce.check_mesh('mesh', read_mesh(tmp_path))
    (tmp_path / 'log.check').write_text(check)
    with pytest.raises(CaseFailed, match=said):
        reduce.check_mesh('mesh', read_mesh(tmp_path))


PATCHES = """
Checking patch topology for multiply connected surfaces...
                   Patch    Faces   Points                  Surface topology
                envelope     1250     1555  ok (non-closed singly connected)
                 gondola      128      152  multiply connected (shared edge)

Checking faceZone topology for multiply connected surfaces...
    No faceZones found.
"""


def test_every_patch_of_a_mesh_has_its_faces_whatever_its_topology(tmp_path):
    (tmp_path / 'log.check').write_text(SOUND + PATCHES)
    assert read_mesh(tmp_path).faces == {'envelope': 1250, 'gondola': 128}


def test_bodies_of_the_half_that_is_cut_off_are_not_missed():
    model = load_tunnel_model('gtmab', load_mount('bottom'))
    half = build_steady_wind_case(model, 'surge', 1.5e-5, PREVIEW).mesh
    transient = build_transient_wind_case(
        model, 'surge', 1.5e-5, PREVIEW, 1.0, TRANSIENT_LENGTHS
    ).mesh
    whole = {'envelope', 'gondola', 'frame', 'panel_left', 'panel_right', 'arm_left', 'arm_right'}
    assert set(transient.bodies) == whole
    assert set(half.bodies) == whole - {'panel_left', 'arm_left'}


def test_no_cell_is_so_coarse_that_a_bar_lies_between_the_middles_of_two_unseen():
    mesh = build_steady_wind_case(
        load_tunnel_model('gtmab', load_mount('bottom')), 'surge', 1.5e-5, PREVIEW
    ).mesh
    around = mesh.files['system/snappyHexMeshDict'].split('refinementRegions')[1]
    levels = re.search(r'arm_left\s*{\s*mode distance;\s*levels \(\((.*)\)\);', around)[1]
    rows = [tuple(map(float, row.split())) for row in levels.split(') (')]
    assert [level for _, level in rows] == [5, 4, 3]  # from the bar outwards; all is at 2 there
    for far, level in rows:
        coarser = BASE_CUBE * 2.0 ** (1 - level)
        assert far > 0.5 * math.sqrt(3.0) * coarser  # a corner of it touches the bar at most


@pytest.mark.parametrize(
    ('gate', 'given', 'said'),
    [
        (
            reduce.check_bodies,
            ('mesh', {'bar': 19}, ['bar']),
            '19 faces on the body bar, fewer than 20',
        ),
        (
            reduce.check_bodies,
            ('mesh', {'hull': 900}, ['hull', 'bar']),
            '0 faces on the body bar',
        ),
        (
            reduce.check_zones,
            ({'up_left': 12}, {'up_left': 1.0}),
            'of up_left has only 12 mesh cells, fewer',
        ),
        (
            reduce.check_zones,
            ({}, {'up_left': 1.0}),
            'of up_left has only 0 mesh cells, fewer',
        ),
        (reduce.check_spread, (0.2, 50), 'varies by 20 %'),
        (reduce.check_spread, (math.nan, 50), 'varies by nan'),
        (reduce.check_spread, (0.0, 12), '12 iterations'),
        (reduce.check_balance, (0.3,), '30 % of the force'),
        (reduce.check_balance, (math.nan,), 'nan % of the force'),
        (reduce.check_brakes, (-0.01,), 'points in the direction of motion'),
        (reduce.check_brakes, (0.0,), 'points in the direction of motion'),
        (reduce.check_brakes, (math.nan,), 'points in the direction of motion'),
        (reduce.check_mean, (0.06, 12.0), r'uncertain by 6 % \(allowed: 5 %\)'),
        (reduce.check_mean, (math.nan, 12.0), 'uncertain by nan'),
        (reduce.check_mean, (math.inf, 12.0), 'uncertain by inf'),  # shorter than one batch
        (
            reduce.check_mean,
            (0.01, 9.9),
            r'covers only 9\.9 hull lengths of flow; at least 10 are',
        ),
    ],
)
def test_gates_refuse_with_the_figure(gate, given, said):
    with pytest.raises(CaseFailed, match=said):
        gate(*given)


def test_gates_let_pass_what_is_at_their_limits():
    reduce.check_bodies('mesh', {'bar': reduce.MIN_FACES}, ['bar'])
    reduce.check_zones({'up_left': reduce.MIN_DISK_CELLS}, {'up_left': 1.0})
    reduce.check_spread(reduce.MAX_SPREAD, reduce.AVERAGED_ITERATIONS)
    reduce.check_balance(reduce.MAX_IMBALANCE)
    reduce.check_brakes(1e-6)
    reduce.check_mean(reduce.MAX_MEAN_ERROR, reduce.MIN_LENGTHS)
