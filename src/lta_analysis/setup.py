# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Install lta_analysis as an ament_python package."""

from setuptools import find_packages, setup

setup(
    name='lta_analysis',
    version='1.0.0',
    packages=find_packages(),
    package_data={'lta_analysis': ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/lta_analysis']),
        ('share/lta_analysis', ['package.xml']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},  # `colcon test` looks for it
    zip_safe=False,
    maintainer='LTA maintainers',
    maintainer_email='maintainers@users.noreply.github.com',
    description='Open recordings, simulate and discover in notebooks.',
    license='Apache-2.0',
    entry_points={'console_scripts': ['lta = lta_cli.command:main']},
)
