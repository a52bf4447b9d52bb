# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Install lta_bringup as an ament_python package, which has no Python of its own."""

from pathlib import Path

from setuptools import setup

setup(
    name='lta_bringup',
    version='1.0.0',
    packages=[],
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/lta_bringup']),
        ('share/lta_bringup', ['package.xml']),
        ('share/lta_bringup/launch', sorted(map(str, Path('launch').glob('*.launch.py')))),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},  # `colcon test` looks for it
    zip_safe=False,
    maintainer='LTA maintainers',
    maintainer_email='maintainers@users.noreply.github.com',
    description='Launch files of LTA, and all that they start.',
    license='Apache-2.0',
    entry_points={'console_scripts': []},
)
