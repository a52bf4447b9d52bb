# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Install lta_energy as an ament_python package."""

from setuptools import find_packages, setup

setup(
    name='lta_energy',
    version='1.0.0',
    packages=find_packages(),
    package_data={'lta_energy': ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/lta_energy']),
        ('share/lta_energy', ['package.xml']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},  # `colcon test` looks for it
    zip_safe=False,
    maintainer='LTA maintainers',
    maintainer_email='maintainers@users.noreply.github.com',
    description='Battery, solar panel, electrical loads and energy accounting.',
    license='Apache-2.0',
    entry_points={'console_scripts': ['energy_monitor = lta_energy.nodes.energy_monitor:main']},
)
