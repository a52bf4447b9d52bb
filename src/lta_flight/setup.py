# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Install lta_flight as an ament_python package."""

from setuptools import find_packages, setup

setup(
    name='lta_flight',
    version='1.0.0',
    packages=find_packages(),
    package_data={'lta_flight': ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/lta_flight']),
        ('share/lta_flight', ['package.xml']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},  # `colcon test` looks for it
    zip_safe=False,
    maintainer='LTA maintainers',
    maintainer_email='maintainers@users.noreply.github.com',
    description='Fly in one process, as a ROS graph or in sweeps, and write report pages.',
    license='Apache-2.0',
    entry_points={
        'console_scripts': [],
        'lta.launch_checks': ['preflight = lta_flight.preflight:check_plan'],
    },
)
