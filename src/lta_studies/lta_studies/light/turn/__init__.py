# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Calibrate the photodiodes of a real light board by a turn in front of a lamp."""
