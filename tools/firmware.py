# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Build both firmware images for one vehicle: `make firmware FIRMWARE=... CORES=... ADC=...`.

The sources are the user's own checkouts, given by environment or make variables:
crazyflie-firmware (GPL, therefore never part of this repository), and PaulStoffregen/cores and
pedvide/ADC for the Teensy. Each must be the version that LTA was tried with. The images hold the
commit of this repository and the hash of the vehicle, which `lta hardware check` and the bridges
read back.
"""

import argparse
from collections.abc import Sequence
import os
from pathlib import Path
import shutil
import socket
import struct
import subprocess
import sys
from typing import Final, NamedTuple

from lta_config.errors import BadInput
from lta_config.schema.crazyflie_file import find_crazyflie, hash_airframe, hash_diodes
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_emulation import emulated_hardware

ROOT: Final = Path(__file__).resolve().parents[1]
CRAZYFLIE: Final = ROOT / 'firmware/crazyflie'
LIGHT_BOARD: Final = ROOT / 'firmware/light_board'
MARK: Final = b'LTAi'  # of lta_identity.h
TOOLS: Final = {
    'make': 'make',
    'gcc': 'gcc',
    'arm-none-eabi-gcc': 'gcc-arm-none-eabi libnewlib-arm-none-eabi',
    'arm-none-eabi-g++': 'gcc-arm-none-eabi libstdc++-arm-none-eabi-newlib',
}
HOST_TOOLS: Final = ('make', 'gcc')
PORT: Final = emulated_hardware.FIRST_PORT  # that cflib scans first
BENCH: Final = 19870  # motors and sensors of the firmware


class Source(NamedTuple):
    """A checkout: its variable, repository, version, commit, and a file that it must have."""

    variable: str
    repository: str
    version: str
    commit: str
    file: str


FIRMWARE: Final = Source(
    'FIRMWARE', 'bitcraze/crazyflie-firmware', '2026.08',
    '54f31e243a0b28b67efef5ba20dbb6d9890a5478', 'vendor/CMSIS/CMSIS/Core/Include/core_cm4.h',
)  # fmt: skip
CORES: Final = Source(
    'CORES', 'PaulStoffregen/cores', '1.62', 'a664effb008d1ac8d8f00f3f19b47c0d1ea46e3b',
    'teensy4/imxrt1062_t41.ld',
)  # fmt: skip
ADC: Final = Source(
    'ADC', 'pedvide/ADC', '9.1', '6e9a359a8efbe47e71a60a89a30caeaf620ceaa6', 'ADC.h'
)


class Identity(NamedTuple):
    """The identity inside an image."""

    commit: int
    vehicle: int


def require_tools(names: Sequence[str]) -> None:
    """Check that the compilers are installed; raise `BadInput` if one is not."""
    missing = [name for name in names if shutil.which(name) is None]
    if missing:
        packages = ' '.join(dict.fromkeys(' '.join(TOOLS[name] for name in missing).split()))
        raise BadInput(
            f'The firmware needs {", ".join(missing)}, which is not installed; run "sudo '
            f'apt install {packages}".'
        )


def require_source(source: Source, any_version: bool) -> Path:
    """Return the folder of a checkout of the right version; raise `BadInput` otherwise."""
    given = os.environ.get(source.variable, '')
    folder = Path(given).expanduser().absolute()
    clone = f'git clone --recursive -b {source.version} https://github.com/{source.repository}'
    if not given:
        raise BadInput(
            f'The firmware needs a checkout of {source.repository}; run "{clone}" and give its '
            f'folder as {source.variable}=FOLDER.'
        )
    if not (folder / source.file).is_file():
        raise BadInput(
            f'{folder} has no {source.file}, so it is no complete checkout of '
            f'{source.repository}; run "{clone}", or "git submodule update --init" in it.'
        )
    commit = read_commit(folder)
    if commit != source.commit and not any_version:
        raise BadInput(
            f'{folder} is at commit {commit[:12] or "unknown"}, but LTA was tried with '
            f'{source.repository} {source.version} ({source.commit[:12]}); run "git checkout '
            f'{source.version}" in it, or add ARGS=--any-version.'
        )
    return folder


def read_commit(folder: Path) -> str:
    """Return the commit of a checkout; empty without one."""
    words = ['git', '-C', str(folder), 'rev-parse', 'HEAD']
    return subprocess.run(words, capture_output=True, text=True, check=False).stdout.strip()


def run_make(*words: str) -> None:
    """Run make, and print its output only if it fails."""
    # Not the flags of the make that called this
    environment = {name: value for name, value in os.environ.items() if name != 'MAKEFLAGS'}
    done = subprocess.run(
        ['make', *words], env=environment, capture_output=True, text=True, check=False
    )
    if done.returncode:
        sys.stderr.write((done.stdout + done.stderr)[-4000:])
        raise BadInput('The build failed; its last lines are above.')


def build_crazyflie(firmware: Path, identity: Identity) -> Path:
    """Build cf2.bin with the app, and return its path."""
    # A former build may hold another version's configuration
    shutil.rmtree(CRAZYFLIE / 'build', ignore_errors=True)
    run_make('-C', str(CRAZYFLIE), '-j2', f'CRAZYFLIE_BASE={firmware}', to_flags(identity))
    words = ['arm-none-eabi-nm', str(CRAZYFLIE / 'build/cf2.elf')]
    symbols = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    if ' T ltaAppStep' not in symbols:
        raise BadInput('cf2.elf does not contain ltaAppStep; do not flash it.')
    image = CRAZYFLIE / 'build/cf2.bin'
    require_identity(image, image.read_bytes(), identity)
    return image


def build_light_board(cores: Path, adc: Path, identity: Identity) -> Path:
    """Build the .hex of the light board, and return its path."""
    run_make(
        '-C', str(LIGHT_BOARD), 'teensy', f'PYTHON={sys.executable}', f'CORES={cores}',
        f'ADC={adc}', to_flags(identity),
    )  # fmt: skip
    image = LIGHT_BOARD / 'build/light_board.hex'
    require_identity(image, read_hex(image.read_text()), identity)
    return image


def require_free_ports(ports: Sequence[int]) -> None:
    """Check that no program has the ports; raise `BadInput`, as an old firmware would answer."""
    for port in ports:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(('', port))
            except OSError:
                raise BadInput(
                    f'Another program has the UDP port {port}, probably the firmware of an '
                    f'earlier rehearsal; end it ("fuser {port}/udp" prints its process).'
                ) from None


def rehearse(firmware: Path, identity: Identity, vehicle: str) -> None:
    """Build the firmware with the app as a Linux process, and fly it in a simulated world."""
    require_free_ports((PORT, BENCH))
    out = CRAZYFLIE / 'build_linux'
    run_make(
        '-C', str(CRAZYFLIE / 'linux'), f'FIRMWARE={firmware}', 'BUILD=app', f'OUT={out}',
        to_flags(identity),
    )  # fmt: skip
    require_free_ports((PORT, BENCH))  # the build took minutes
    with subprocess.Popen([out / 'crazyflie', str(PORT), str(BENCH)]) as process:
        try:
            emulated_hardware.main(['--vehicle', vehicle, '--bench-port', str(BENCH)])
        finally:
            process.kill()


def to_flags(identity: Identity) -> str:
    """Return the compiler's definitions of an identity."""
    commit, vehicle = identity
    return f'IDENTITY=-DLTA_COMMIT=0x{commit:08x}u -DLTA_VEHICLE=0x{vehicle:08x}u'


def read_hex(text: str) -> bytes:
    """Return the data of an Intel hex file, in its order."""
    records = (bytes.fromhex(line[1:]) for line in text.split())
    return b''.join(record[4:-1] for record in records if record[3] == 0)


def require_identity(path: Path, image: bytes, identity: Identity) -> None:
    """Raise `BadInput` if an image does not hold the identity."""
    if MARK + struct.pack('<II', *identity) not in image:
        raise BadInput(f'{path} does not contain its version and vehicle; do not flash it.')


def main() -> None:
    """Build what was asked for."""
    parser = argparse.ArgumentParser(description='Build both firmware images.')
    parser.add_argument('--only', choices=('crazyflie', 'light_board'), help='build one of them')
    parser.add_argument('--any-version', action='store_true', help='accept other sources')
    parser.add_argument('--rehearse', action='store_true', help='run the firmware on this machine')
    asked = parser.parse_args()
    name = os.environ.get('VEHICLE') or 'gtmab'
    require_tools(HOST_TOOLS if asked.rehearse else tuple(TOOLS))
    vehicle = load_vehicle_file(name)
    commit = int(read_commit(ROOT)[:8] or '0', 16)
    if asked.rehearse:
        firmware = require_source(FIRMWARE, asked.any_version)
        airframe = hash_airframe(vehicle, find_crazyflie(name, vehicle.name))
        rehearse(firmware, Identity(commit, airframe), name)
        return
    if asked.only != 'light_board':
        firmware = require_source(FIRMWARE, asked.any_version)
    if asked.only != 'crazyflie':
        cores, adc = (require_source(each, asked.any_version) for each in (CORES, ADC))
    if asked.only != 'light_board':
        airframe = hash_airframe(vehicle, find_crazyflie(name, vehicle.name))
        image = build_crazyflie(firmware, Identity(commit, airframe))
        sys.stdout.write(
            f'{image}: ltaAppStep, commit {commit:08x}, {vehicle.name} {airframe:08x}\n'
        )
    if asked.only != 'crazyflie':
        diodes = hash_diodes(vehicle)
        image = build_light_board(cores, adc, Identity(commit, diodes))
        sys.stdout.write(f'{image}: commit {commit:08x}, {vehicle.name} {diodes:08x}\n')


if __name__ == '__main__':
    try:
        main()
    except BadInput as error:
        sys.stderr.write(f'{error}\n')
        sys.exit(2)
