# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Install lta_bag as an ament_python package."""

from setuptools import find_packages, setup

setup(
    name='lta_bag',
    version='1.0.0',
    packages=find_packages(),
    package_data={'lta_bag': ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/lta_bag']),
        ('share/lta_bag', ['package.xml']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},  # `colcon test` looks for it
    zip_safe=False,
    maintainer='LTA maintainers',
    maintainer_email='maintainers@users.noreply.github.com',
    description='Write and read bags: files, messages, recovery, provenance.',
    license='Apache-2.0',
    entry_points={'console_scripts': []},
)
