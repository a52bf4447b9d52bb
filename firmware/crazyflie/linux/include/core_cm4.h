// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* In place of ARM's header of the processor core: what ST's headers need of it to compile. */
#pragma once

#include <stdint.h>

#define __I volatile const
#define __O volatile
#define __IO volatile

/* No interrupt is ever being served: drivers run in threads. */
typedef struct {
  uint32_t ICSR;
} SCB_Type;
static SCB_Type no_interrupts __attribute__((unused));
#define SCB (&no_interrupts)
#define SCB_ICSR_VECTACTIVE_Msk 0x1FFu
