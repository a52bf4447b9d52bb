"""Install lta_analysis as an ament_python package."""

from setuptools import find_packages, setup

setup(
    name='lta_analysis',
    version='1.0.0',
    packages=find_packages(),
    package_data={'lta_analysis': ['py.typed', 'report/assets/*', 'discovery/naming/*.yaml']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/lta_analysis']),
        ('share/lta_analysis', ['package.xml']),
    ],
    install_requires=['setuptools'],
    zip_safe=False,
    maintainer='LTA maintainers',
    maintainer_email='maintainers@users.noreply.github.com',
    description='What we learn: bag tables, reports and the lta command.',
    license='Apache-2.0',
    entry_points={'console_scripts': ['lta = lta_analysis.command:main']},
)
