# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Install lta_windtunnel as an ament_python package."""

from setuptools import find_packages, setup

setup(
    name='lta_windtunnel',
    version='1.0.0',
    packages=find_packages(),
    package_data={'lta_windtunnel': ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/lta_windtunnel']),
        ('share/lta_windtunnel', ['package.xml']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},  # `colcon test` looks for it
    zip_safe=False,
    maintainer='LTA maintainers',
    maintainer_email='maintainers@users.noreply.github.com',
    description='Virtual wind tunnel: drag and rotor wrenches of a vehicle from its shape.',
    license='Apache-2.0',
    entry_points={'console_scripts': []},
)
