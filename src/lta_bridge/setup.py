"""Install lta_bridge as an ament_python package."""

from setuptools import find_packages, setup

setup(
    name='lta_bridge',
    version='1.0.0',
    packages=find_packages(),
    package_data={'lta_bridge': ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/lta_bridge']),
        ('share/lta_bridge', ['package.xml']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},  # `colcon test` looks for it
    zip_safe=False,
    maintainer='LTA maintainers',
    maintainer_email='maintainers@users.noreply.github.com',
    description='Recorder and player of bags, and links to real hardware.',
    license='Apache-2.0',
    entry_points={
        'console_scripts': [
            'crazyflie_bridge = lta_bridge.nodes.crazyflie_bridge:main',
            'description = lta_bridge.nodes.description:main',
            'live = lta_bridge.nodes.live:main',
            'player = lta_bridge.nodes.player:main',
            'recorder = lta_bridge.nodes.recorder:main',
            'teleop = lta_bridge.nodes.teleop:main',
            'tracker = lta_bridge.nodes.tracker:main',
            'teensy_bridge = lta_bridge.nodes.teensy_bridge:main',
        ]
    },
)
