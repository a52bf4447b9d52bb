# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Install lta_report as an ament_python package."""

from setuptools import find_packages, setup

setup(
    name='lta_report',
    version='1.0.0',
    packages=find_packages(),
    package_data={'lta_report': ['py.typed', 'assets/*']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/lta_report']),
        ('share/lta_report', ['package.xml']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},  # `colcon test` looks for it
    zip_safe=False,
    maintainer='LTA maintainers',
    maintainer_email='maintainers@users.noreply.github.com',
    description='Code shared by all results: HTML pages, pictures, folders, progress, workers.',
    license='Apache-2.0',
    entry_points={'console_scripts': []},
)
