# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The checks of `lta doctor`: each finds what it looks for, and the conversation is a real one."""

import io
import socket
import tempfile

from lta_bridge.hardware.check_result import grade_value, HardwareCheck
from lta_cli import doctor
from lta_cli.doctor import dds, machine, software
import pytest
from rich.console import Console


def test_a_figure_is_graded_against_both_limits():
    states = [
        grade_value('x', figure, 2.0, 1.0, 'found', 'do').state for figure in (3, 2, 1.5, 1, 0)
    ]
    assert states == ['ok', 'ok', 'warn', 'warn', 'fail']
    assert grade_value('x', 3, 2.0, 1.0, 'found', 'do').remedy == ''
    assert grade_value('x', 1, 2.0, 1.0, 'found', 'do').remedy == 'do'


def test_only_failures_make_the_status():
    fine, slow, broken = (HardwareCheck('x', state, '') for state in ('ok', 'warn', 'fail'))
    assert doctor.exit_status([fine, slow]) == 0
    assert doctor.exit_status([fine, slow, broken]) == 1
    assert doctor.exit_status([]) == 0


def test_a_check_that_crashes_is_a_result(monkeypatch):
    def crash():
        raise KeyError('MemAvailable')

    monkeypatch.setattr(doctor, 'MACHINE_CHECKS', {'memory': crash})
    (check,) = doctor.run_checks()
    assert (check.name, check.state) == ('memory', 'fail')
    assert 'MemAvailable' in check.found


def test_brackets_in_what_was_found_are_shown_as_they_are():
    page = io.StringIO()
    result = HardwareCheck('disk', 'fail', '[Errno 28] No space left on [/]', 'Make room.')
    doctor.print_checks([result], Console(file=page, width=100))
    assert '[Errno 28] No space left on [/]' in page.getvalue()
    assert 'Make room.' in page.getvalue()


@pytest.mark.parametrize(
    ('version', 'state'), [((3, 10), 'fail'), ((3, 11), 'ok'), ((3, 14), 'ok'), ((3, 15), 'fail')]
)
def test_python(version, state):
    assert machine.check_python_version(version).state == state


def test_memory_is_read_in_kibibytes(tmp_path):
    table = tmp_path / 'meminfo'
    table.write_text('MemTotal: 4000000 kB\nMemAvailable:    1000000 kB\n')
    check = machine.check_available_memory(table)
    assert check.state == 'warn'
    assert check.found == '1024 MB available'


def test_a_version_other_than_the_pinned_one_is_named(tmp_path):
    constraints = tmp_path / 'constraints.txt'
    constraints.write_text('# pins\nPyYAML==0.1\nnot-installed==1.0\n')
    check = software.check_dependency_versions(constraints)
    assert check.state == 'warn'
    assert check.found.startswith('pyyaml ')
    assert check.found.endswith(' is installed, LTA was tested with 0.1')


def test_a_wheel_that_does_not_import_is_named(monkeypatch):
    monkeypatch.setattr(software, 'MODULES', ('json', 'no_such_wheel'))
    check = software.check_dependency_imports()
    assert check.state == 'fail'
    assert 'no_such_wheel' in check.found
    assert 'json' not in check.found


def test_a_library_that_ends_the_process_does_not_end_the_doctor(monkeypatch, tmp_path):
    (tmp_path / 'bad_library.py').write_text('import os; os._exit(102)')
    monkeypatch.setenv('PYTHONPATH', str(tmp_path))
    monkeypatch.setattr(software, 'MODULES', ('json', 'bad_library'))
    assert (
        software.check_dependency_imports().found == 'cannot import bad_library: exit status 102'
    )


def test_packages_are_looked_up_in_the_ament_index(monkeypatch, tmp_path):
    index = tmp_path / 'share/ament_index/resource_index/packages'
    index.mkdir(parents=True)
    for name in software.OWN_PACKAGES:
        (index / f'lta_{name}').touch()
    monkeypatch.setenv('AMENT_PREFIX_PATH', f'/nowhere:{tmp_path}')
    assert software.check_workspace_packages().state == 'ok'
    (index / 'lta_vlc').unlink()
    check = software.check_workspace_packages()
    assert check.state == 'fail'
    assert check.found.endswith(': lta_vlc')


def test_ports_are_those_of_ddsi_rtps():
    assert dds.domain_ports(0)[:2] == [7410, 7411]
    assert dds.domain_ports(42)[0] == 17910
    assert len(dds.domain_ports(1)) == 2 * dds.PARTICIPANTS


def test_a_listener_in_the_domain_is_noticed(monkeypatch):
    domain = dds.find_free_domain()
    monkeypatch.setenv('ROS_DOMAIN_ID', str(domain))
    assert dds.check_ports().state == 'ok'
    port = dds.domain_ports(domain)[2]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
        listener.bind(('127.0.0.1', port))
        check = dds.check_ports()
        assert dds.find_free_domain() != domain
    assert check.state == 'warn'
    assert str(port) in check.found


@pytest.mark.parametrize('text', ['-1', '233', 'blimp', '1.0'])
def test_a_domain_that_is_none_is_refused(monkeypatch, text):
    monkeypatch.setenv('ROS_DOMAIN_ID', text)
    check = dds.check_ports()
    assert check.state == 'fail'
    assert text in check.found


def test_a_cache_that_is_lost_with_the_temporary_files_is_a_warning(monkeypatch, tmp_path):
    monkeypatch.setattr(tempfile, 'tempdir', str(tmp_path))
    monkeypatch.setenv('XDG_CACHE_HOME', str(tmp_path / 'chosen'))
    assert software.check_cache_folder().state == 'ok'
    monkeypatch.setenv('XDG_CACHE_HOME', '/proc/nowhere')
    check = software.check_cache_folder()
    assert check.state == 'warn'
    assert str(tmp_path / 'lta-cache-') in check.found
    assert 'XDG_CACHE_HOME' in check.remedy
