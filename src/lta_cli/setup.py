# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Install lta_cli as an ament_python package."""

from setuptools import find_packages, setup

setup(
    name='lta_cli',
    version='1.0.0',
    packages=find_packages(),
    package_data={'lta_cli': ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/lta_cli']),
        ('share/lta_cli', ['package.xml']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},  # `colcon test` looks for it
    zip_safe=False,
    maintainer='LTA maintainers',
    maintainer_email='maintainers@users.noreply.github.com',
    description='The lta command.',
    license='Apache-2.0',
    entry_points={'console_scripts': ['lta = lta_cli.command:main']},
)
