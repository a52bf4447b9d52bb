# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The header of our files as ament_copyright reads it; an entry point of this package tells it."""

from types import SimpleNamespace

# {copyright} is what it has found by itself
APACHE_2 = SimpleNamespace(
    name='Apache License, Version 2.0',
    spdx='Apache-2.0',
    file_headers=['{copyright}\nSPDX-License-Identifier: Apache-2.0'],
    license_files=[],
    contributing_files=['Contributions are under the Apache License 2.0.'],
)
