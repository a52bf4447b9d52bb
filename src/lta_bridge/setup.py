# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Install lta_bridge as an ament_python package.

The classes of the light board's messages are generated first, by pymavlink from their XML.
"""

from pathlib import Path

from setuptools import find_packages, setup
from setuptools.command.egg_info import egg_info

HERE = Path(__file__).resolve().parent  # not the link that colcon makes
XML = HERE.parents[1] / 'firmware/light_board/mavlink/link.xml'
MODULE = HERE / 'lta_bridge/teensy/_generated/mavlink.py'


class GenerateMessages(egg_info):
    """The step that an install and a `develop` of colcon have in common."""

    def run(self) -> None:
        """Write the module."""
        # Only here: colcon reads this file without building it
        from pymavlink.generator import mavgen

        options = mavgen.Opts(str(MODULE), wire_protocol='2.0', language='Python3', validate=True)
        if not mavgen.mavgen(options, [str(XML)]):
            raise SystemExit(f'pymavlink cannot read {XML}; the lines above say why.')
        super().run()


setup(
    name='lta_bridge',
    version='1.0.0',
    packages=find_packages(),
    package_data={'lta_bridge': ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/lta_bridge']),
        ('share/lta_bridge', ['package.xml']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},  # `colcon test` looks for it
    cmdclass={'egg_info': GenerateMessages},
    zip_safe=False,
    maintainer='LTA maintainers',
    maintainer_email='maintainers@users.noreply.github.com',
    description='Recorder and player of bags, and links to real hardware.',
    license='Apache-2.0',
    entry_points={
        'console_scripts': [
            'crazyflie_bridge = lta_bridge.nodes.crazyflie_bridge:main',
            'description = lta_bridge.nodes.description:main',
            'live = lta_bridge.nodes.live:main',
            'pilot = lta_bridge.nodes.pilot:main',
            'player = lta_bridge.nodes.player:main',
            'recorder = lta_bridge.nodes.recorder:main',
            'teleop = lta_bridge.nodes.teleop:main',
            'tracker = lta_bridge.nodes.tracker:main',
            'teensy_bridge = lta_bridge.nodes.teensy_bridge:main',
        ]
    },
)
