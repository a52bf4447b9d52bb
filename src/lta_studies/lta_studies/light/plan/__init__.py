# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Plan lamp positions and frequencies so that a drone receives a lamp everywhere."""
