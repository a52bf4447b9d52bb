// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* The light board without its hardware: rows in, MAVLink 2 out, questions for the time answered. */
#pragma once
#include "goertzel.h"
#include "ring.h"
/* Messages lie at any address, and a Cortex-M7 faults on 64 bits at an odd one: byte by byte. */
#define MAVLINK_ALIGNED_FIELDS 0
#include "mavlink.h"
#include <stddef.h>

#define LIGHT_BOARD_DIALECT 1
#define LIGHT_BOARD_WINDOW 1000 /* rows of peaks: 0.1 s at 10 kS/s */

typedef struct {
    unsigned diodes;
    float sample_rate;   /* rows a second of the board's clock [Hz] */
    float peak_frequency; /* the beacon, where raw blocks are too much for the link [Hz]; 0 sends raw blocks */
    uint64_t start_us;   /* board time of row 0 */
    /* Sends all of a frame or nothing; false where the link takes none now. */
    bool (*send)(void *link, const uint8_t *bytes, size_t count);
    void *link;
} light_board_config_t;

typedef struct {
    light_board_config_t config;
    ring_t ring;
    volatile uint64_t sampled; /* rows since boot, lost ones with them: the sequence shows a gap */
    volatile uint32_t overruns; /* rows that found no room */
    uint64_t next_beat_us;
    goertzel_t peaks[RING_DIODES];
    uint64_t window_first;
    uint32_t window_rows;
    mavlink_message_t partial, heard; /* the message that comes in, and the last whole one */
    mavlink_status_t parser;
} light_board_t;

void light_board_begin(light_board_t *board, light_board_config_t config);
void light_board_sample(light_board_t *board, const uint16_t *values); /* from the sampling interrupt */
void light_board_hear(light_board_t *board, const uint8_t *bytes, size_t count, uint64_t now_us);
void light_board_work(light_board_t *board, uint64_t now_us);          /* from the loop, as often as can be */
