# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Install lta_data as an ament_python package."""

from setuptools import find_packages, setup

setup(
    name='lta_data',
    version='1.0.0',
    packages=find_packages(),
    package_data={'lta_data': ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/lta_data']),
        ('share/lta_data', ['package.xml']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},  # `colcon test` looks for it
    zip_safe=False,
    maintainer='LTA maintainers',
    maintainer_email='maintainers@users.noreply.github.com',
    description='Read, import, export, check, compare and plot recordings.',
    license='Apache-2.0',
    entry_points={'console_scripts': []},
)
