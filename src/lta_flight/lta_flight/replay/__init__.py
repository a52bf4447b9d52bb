# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Run nodes again on recorded data, and compare their outputs with the recording."""
