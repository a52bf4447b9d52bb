# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What tests of several packages share: stand-ins, small bags, a full disk, plain laws."""

from contextlib import contextmanager
from pathlib import Path
import resource
import sys

from lta_bag import BagWriter, build_offered_qos
from lta_bag.schemas import load_jazzy_types
from lta_config.compilation.flat import render_core_source
from lta_config.compilation.kernel_cache import load_kernel
from lta_control import autopilot
from lta_windtunnel.openfoam.case import OPENFOAM_PROGRAMS
from numba.core import config
import numpy as np
import pytest

FAKE = Path(__file__).parent / 'windtunnel' / 'fake_openfoam.py'
TOPICS = {
    '/clock': 'rosgraph_msgs/msg/Clock',
    '/lta1/odom': 'nav_msgs/msg/Odometry',
    '/lta1/energy/reserve': 'std_msgs/msg/Bool',
}
START = 1_000_000_000


def stamp(time):
    return load_jazzy_types().types['builtin_interfaces/msg/Time'](time // 10**9, time % 10**9)


def header(time):
    return load_jazzy_types().types['std_msgs/msg/Header'](stamp(time), 'map')


def odometry(time, i):
    types = load_jazzy_types().types
    vector = types['geometry_msgs/msg/Vector3']
    turn = types['geometry_msgs/msg/Quaternion'](0.0, 0.0, np.sin(0.05 * i), np.cos(0.05 * i))
    place = types['geometry_msgs/msg/Point'](0.1 * i, -0.2 * i, 0.5)
    return types['nav_msgs/msg/Odometry'](
        header(time),
        'base_link',
        types['geometry_msgs/msg/PoseWithCovariance'](
            types['geometry_msgs/msg/Pose'](place, turn), np.arange(36.0) + i
        ),
        types['geometry_msgs/msg/TwistWithCovariance'](
            types['geometry_msgs/msg/Twist'](vector(0.5, 0.0, 0.0), vector(0.0, 0.0, 0.1)),
            np.zeros(36),
        ),
    )


@pytest.fixture
def fake(tmp_path, monkeypatch):
    """Return a folder of cases that stand-ins for OpenFOAM will solve."""
    programs = tmp_path / 'bin'
    programs.mkdir()
    for name in OPENFOAM_PROGRAMS:
        (programs / name).write_text(f'#!/bin/sh\nexec {sys.executable} -IS {FAKE} {name}\n')
        (programs / name).chmod(0o755)
    monkeypatch.setenv('PATH', f'{programs}:/usr/bin:/bin')
    return tmp_path / 'cases'


@pytest.fixture
def room():
    """Return a context within which no file takes more than some bytes."""

    @contextmanager
    def limited(size):
        soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
        try:
            yield
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))

    return limited


@pytest.fixture(scope='module')
def plain_laws():
    """
    Fly control laws by their texts as Python, and return what takes one in place of `compiled`.

    It takes a quarter of a minute to compile one; test/property/test_laws.py does, and compares.
    """

    def plain(*words, **bound):
        with pytest.MonkeyPatch.context() as while_loading:
            while_loading.setattr(config, 'DISABLE_JIT', 1)
            return load_kernel(render_core_source(*words, **bound)).step

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(autopilot, 'compile_core', plain)
        yield plain


@pytest.fixture
def prompt_cflib(monkeypatch):
    """Let cflib, which waits for packets a second at a time, see sooner that all is over."""
    udpdriver = pytest.importorskip('cflib.crtp.udpdriver')
    receive = udpdriver.UdpDriver.receive_packet

    def promptly(driver, wait=0):
        return receive(driver, min(wait, 0.05))

    monkeypatch.setattr(udpdriver.UdpDriver, 'receive_packet', promptly)


@pytest.fixture
def types():
    """Return the message classes of ROS 2 Jazzy by name."""
    return load_jazzy_types().types


@pytest.fixture
def record(tmp_path):
    """Return a function that writes (topic, type, message, log time) into a bag."""

    def make(messages, name='bag', provenance=None):
        folder = tmp_path / name
        known = set()
        with BagWriter(folder, provenance or {}) as bag:
            for topic, type_name, message, log_time in messages:
                if topic not in known:
                    bag.add_topic(
                        topic, type_name, [build_offered_qos('reliable', 'volatile', 10)]
                    )
                    known.add(topic)
                bag.write(
                    topic, bytes(load_jazzy_types().serialize_cdr(message, type_name)), log_time
                )
        return folder

    return make


@pytest.fixture
def flight_bag(record):
    """Return a bag of 40 steps of 10 ms whose log times lie 1000 s behind its stamps."""
    messages = []
    for i in range(40):
        time = START + i * 10**7
        log = time + 10**12
        clock = load_jazzy_types().types['rosgraph_msgs/msg/Clock'](stamp(time))
        messages.append(('/clock', TOPICS['/clock'], clock, log))
        messages.append(('/lta1/odom', TOPICS['/lta1/odom'], odometry(time, i), log))
        if i % 10 == 0:
            flag = load_jazzy_types().types['std_msgs/msg/Bool'](i >= 20)
            topic = '/lta1/energy/reserve'
            messages.append((topic, TOPICS[topic], flag, log))
    return record(messages, provenance={'seed': '11', 'scenario': 'lamp'})
