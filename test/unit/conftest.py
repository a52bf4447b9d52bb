"""What tests of several packages share: stand-ins, a full disk, plain laws, a prompt cflib."""

from contextlib import contextmanager
from pathlib import Path
import resource
import sys

from lta_config.kernel_cache import load
from lta_control import pilot
from lta_sim.cfd.engine import PROGRAMS
from lta_sim.flat import source
from numba.core import config
import pytest

FAKE = Path(__file__).parent / 'sim' / 'cfd' / 'fake_openfoam.py'


@pytest.fixture
def fake(tmp_path, monkeypatch):
    """Return a folder of cases that stand-ins for OpenFOAM will solve."""
    programs = tmp_path / 'bin'
    programs.mkdir()
    for name in PROGRAMS:
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

    def plain(*words):
        with pytest.MonkeyPatch.context() as while_loading:
            while_loading.setattr(config, 'DISABLE_JIT', 1)
            return load(source(*words)).step

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pilot, 'compiled', plain)
        yield plain


@pytest.fixture
def prompt_cflib(monkeypatch):
    """Let cflib, which waits for packets a second at a time, see sooner that all is over."""
    udpdriver = pytest.importorskip('cflib.crtp.udpdriver')
    receive = udpdriver.UdpDriver.receive_packet

    def promptly(driver, wait=0):
        return receive(driver, min(wait, 0.05))

    monkeypatch.setattr(udpdriver.UdpDriver, 'receive_packet', promptly)
