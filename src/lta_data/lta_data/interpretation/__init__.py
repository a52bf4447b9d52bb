# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Score readings of a log by kinematics, for the draft of an import and the check of a bag."""
