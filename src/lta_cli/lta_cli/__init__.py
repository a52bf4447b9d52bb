# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The `lta` command line: its verbs and the checks of the machine."""
