# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Interface to OpenFOAM: its input and output files, and its programs."""
