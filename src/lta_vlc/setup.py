# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Install lta_vlc as an ament_python package."""

from setuptools import find_packages, setup

setup(
    name='lta_vlc',
    version='1.0.0',
    packages=find_packages(),
    package_data={'lta_vlc': ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/lta_vlc']),
        ('share/lta_vlc', ['package.xml']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},  # `colcon test` looks for it
    zip_safe=False,
    maintainer='LTA maintainers',
    maintainer_email='maintainers@users.noreply.github.com',
    description='Demodulation of flickering lamps, and bearing and position of a lamp.',
    license='Apache-2.0',
    entry_points={'console_scripts': ['demodulator = lta_vlc.nodes.demodulator:main']},
)
