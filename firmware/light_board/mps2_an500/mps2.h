// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* What the programs for Arm's MPS2 board with a Cortex-M7 (AN500) share: its registers. */
#pragma once
#include <stdint.h>

#define REGISTER(address) (*(volatile uint32_t *)(address))
#define SYSTICK_CONTROL REGISTER(0xE000E010)
#define SYSTICK_RELOAD REGISTER(0xE000E014)
#define SYSTICK_CURRENT REGISTER(0xE000E018)
#define COPROCESSORS REGISTER(0xE000ED88)
#define UART_DATA REGISTER(0x40004000) /* CMSDK APB UART */
#define UART_STATE REGISTER(0x40004004)
#define UART_CONTROL REGISTER(0x40004008)
#define UART_INTERRUPT REGISTER(0x4000400C)
#define UART_DIVIDER REGISTER(0x40004010)

enum { TX_FULL = 1, RX_FULL = 2, ENABLE_BOTH = 3, COUNT_INTERRUPT_CPU = 7, FLOATING_POINT = 0xF << 20 };
enum { CLOCK_MHZ = 25, PERIOD_US = 100, DIODES = 8 };

extern uint32_t stack_top;

static void begin_hardware(void)
{
    COPROCESSORS |= FLOATING_POINT;
    __asm__ volatile("dsb; isb");
    UART_DIVIDER = 16;
    UART_CONTROL = ENABLE_BOTH;
}

static void begin_systick(uint32_t period)
{
    SYSTICK_RELOAD = period - 1;
    SYSTICK_CURRENT = 0;
    SYSTICK_CONTROL = COUNT_INTERRUPT_CPU;
}

static void fault(void)
{
    for (;;) {
    }
}
