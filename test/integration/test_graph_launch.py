# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""`lta launch`: who starts the graph, one simulated flight a domain, and naming who hangs."""

import os

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from lta_config.errors import BadInput
from lta_flight import flight
from lta_flight.flight import DomainLock
from lta_graph.ros.listener import DiagnosticsListener
import pytest
import rclpy
from rclpy.context import Context
from waiting import wait_until


@pytest.fixture
def other_ros(tmp_path, monkeypatch):
    """Put a `ros2` of another ROS on the PATH; return the file that it would leave."""
    program, trace = tmp_path / 'other' / 'ros2', tmp_path / 'called'
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\ntouch {trace}\n')
    program.chmod(0o755)
    monkeypatch.setenv('PATH', f'{program.parent}:{os.environ["PATH"]}')
    monkeypatch.delenv('LTA_UNDERLAY', raising=False)
    return trace


def test_the_command_of_the_wheels_never_asks_another_ros(lta, other_ros, tmp_path):
    words = ['vehicle:=/nowhere/v.yaml', f'bag:={tmp_path / "bag"}']
    result = lta.run('launch', 'fly', *words)
    assert not other_ros.exists()
    assert result.returncode == 2
    assert result.stdout == ''
    assert result.stderr == 'There is no vehicle file /nowhere/v.yaml; check the path.\n'


@pytest.mark.long
def test_a_second_graph_on_the_domain_is_refused_whoever_comes_first(lta, flying, tmp_path):
    # Without a task, the first one does not end by itself
    first = lta.start('launch', 'fly', 'commanded:=true', f'bag:={tmp_path / "bag"}')
    flying(0.1)
    for words in (
        ('fly', '--out', tmp_path / 'second'),
        ('launch', 'fly', 'robot:=lta2', f'bag:={tmp_path / "second"}'),
    ):
        result = lta.run(*words)
        assert result.returncode == 2
        assert 'lta1 is flying on ROS domain' in result.stderr
        assert 'export ROS_DOMAIN_ID=' in result.stderr
        assert result.stderr.count('\n') == 1
    assert not (tmp_path / 'second').exists()
    first.interrupt()
    assert first.end() == 130


def test_a_listener_hears_its_own_robot_alone(domain_id):
    context = Context()
    rclpy.init(context=context, domain_id=domain_id)
    node = rclpy.create_node('teller', context=context)
    publisher = node.create_publisher(DiagnosticArray, '/diagnostics', 10)
    told = [
        DiagnosticStatus(name=f'{robot}/simulator: flight', hardware_id=robot, message=robot)
        for robot in ('lta1', 'lta2')
    ]
    with DiagnosticsListener('lta2') as second, DiagnosticsListener() as first:

        def step():
            publisher.publish(DiagnosticArray(status=told[::-1]))
            publisher.publish(DiagnosticArray(status=told))
            first.poll(0.02)
            second.poll(0.02)

        wait_until(lambda: first.facts and second.facts, 'facts for both listeners', step=step)
        assert first.facts['simulator: flight'].message == 'lta1'
        assert second.facts['simulator: flight'].message == 'lta2'
    node.destroy_node()
    context.try_shutdown()


def test_the_lock_is_of_the_domain_and_says_who_holds_it(domain_id, monkeypatch, tmp_path):
    monkeypatch.setenv('XDG_RUNTIME_DIR', str(tmp_path))
    monkeypatch.setenv('ROS_DOMAIN_ID', str(flight.HIGHEST_DOMAIN))
    with DomainLock('blimp'):
        with pytest.raises(BadInput, match=r'^blimp is flying on .*export ROS_DOMAIN_ID=0\.$'):
            DomainLock('lta2').__enter__()
        monkeypatch.setenv('ROS_DOMAIN_ID', '7')
        with DomainLock('lta2'):
            pass
    monkeypatch.setenv('ROS_DOMAIN_ID', str(flight.HIGHEST_DOMAIN))
    with DomainLock('lta2'):
        pass


def test_a_lock_that_is_a_link_to_somebody_elses_file_is_refused(monkeypatch, tmp_path):
    monkeypatch.setenv('XDG_RUNTIME_DIR', str(tmp_path))
    monkeypatch.setenv('ROS_DOMAIN_ID', '7')
    precious = tmp_path / 'precious'
    precious.write_text('kept')
    (tmp_path / f'lta-{os.getuid()}-7.lock').symlink_to(precious)
    with pytest.raises(BadInput, match=r'cannot be opened .*; remove the file\.$'):
        DomainLock('lta2').__enter__()
    assert precious.read_text() == 'kept'
