# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The contents of each kind of file, as pydantic models."""
