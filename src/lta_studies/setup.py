# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Install lta_studies as an ament_python package."""

from setuptools import find_packages, setup

setup(
    name='lta_studies',
    version='1.0.0',
    packages=find_packages(),
    package_data={'lta_studies': ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/lta_studies']),
        ('share/lta_studies', ['package.xml']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},  # `colcon test` looks for it
    zip_safe=False,
    maintainer='LTA maintainers',
    maintainer_email='maintainers@users.noreply.github.com',
    description='Studies of light, energy, missions, wind, tuning and platforms.',
    license='Apache-2.0',
    entry_points={'console_scripts': []},
)
