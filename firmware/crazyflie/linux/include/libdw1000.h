// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* In place of the driver of a positioning deck that is not built here. */
#pragma once

typedef struct dwDevice_s dwDevice_t;
