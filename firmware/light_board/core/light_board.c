// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
#include "light_board.h"
#include "lta_identity.h"
#include <string.h>

enum { SYSTEM = 1, COMPONENT = 191, CONTROLLER = 18, NO_AUTOPILOT = 8, ACTIVE = 4, ADC_BITS = 12 };
#define BEAT_US 1000000u
#define VALUES MAVLINK_MSG_LTA_LIGHT_BLOCK_FIELD_SAMPLES_LEN

/* Neither static nor const: the compiler would fold it, and nobody would find it in the image. */
lta_identity_t light_board_identity = LTA_IDENTITY;

void light_board_begin(light_board_t *board, light_board_config_t config)
{
    memset(board, 0, sizeof *board);
    board->config = config;
}

void light_board_sample(light_board_t *board, const uint16_t *values)
{
    row_t row = {.number = board->sampled};
    memcpy(row.values, values, board->config.diodes * sizeof *values);
    if (!ring_put(&board->ring, &row))
        board->overruns = board->overruns + 1;
    board->sampled = board->sampled + 1;
}

static bool send(light_board_t *board, const mavlink_message_t *message)
{
    uint8_t bytes[MAVLINK_MAX_PACKET_LEN];
    return board->config.send(board->config.link, bytes, mavlink_msg_to_send_buffer(bytes, message));
}

/* Rows are sampled by the crystal that the board's time counts: a row's number is its time. */
static uint64_t time_of(const light_board_t *board, uint64_t row)
{
    return board->config.start_us + (uint64_t)((double)row * 1e6 / board->config.sample_rate + 0.5);
}

/* Send the rows that wait, as far as the link takes them; a frame holds rows without a gap. */
static void send_blocks(light_board_t *board)
{
    const unsigned diodes = board->config.diodes;
    const uint32_t full = VALUES / diodes;
    while (ring_waiting(&board->ring) >= full) {
        uint16_t samples[VALUES] = {0};
        const uint64_t first = ring_peek(&board->ring, 0)->number;
        uint32_t rows = 0;
        for (const row_t *row; rows < full && (row = ring_peek(&board->ring, rows))->number == first + rows; rows++)
            memcpy(samples + rows * diodes, row->values, diodes * sizeof *samples);
        mavlink_message_t message;
        mavlink_msg_lta_light_block_pack(SYSTEM, COMPONENT, &message, time_of(board, first), (uint32_t)first,
                                         diodes, rows, samples);
        if (!send(board, &message))
            return;
        ring_drop(&board->ring, rows);
    }
}

static void send_peaks(light_board_t *board)
{
    float amplitude[RING_DIODES] = {0}, noise[RING_DIODES] = {0};
    for (unsigned i = 0; i < board->config.diodes; i++)
        goertzel_end(&board->peaks[i], &amplitude[i], &noise[i]);
    mavlink_message_t message;
    mavlink_msg_lta_light_peaks_pack(SYSTEM, COMPONENT, &message, time_of(board, board->window_first),
                                     (uint32_t)board->window_first, board->window_rows,
                                     board->config.peak_frequency, board->config.diodes, amplitude, noise);
    send(board, &message); /* one that finds no room is old when there is room */
}

/* Take the rows that wait into the window; a gap begins it anew. */
static void find_peaks(light_board_t *board)
{
    for (uint32_t waiting = ring_waiting(&board->ring); waiting > 0; waiting--) {
        const row_t *row = ring_peek(&board->ring, 0);
        if (row->number != board->window_first + board->window_rows)
            board->window_rows = 0;
        for (unsigned i = 0; i < board->config.diodes; i++) {
            if (board->window_rows == 0)
                goertzel_begin(&board->peaks[i], board->config.peak_frequency, board->config.sample_rate);
            goertzel_add(&board->peaks[i], row->values[i]);
        }
        if (board->window_rows++ == 0)
            board->window_first = row->number;
        ring_drop(&board->ring, 1);
        if (board->window_rows == LIGHT_BOARD_WINDOW) {
            send_peaks(board);
            board->window_rows = 0;
        }
    }
}

static void send_status(light_board_t *board, uint64_t now_us)
{
    mavlink_message_t message;
    mavlink_msg_heartbeat_pack(SYSTEM, COMPONENT, &message, CONTROLLER, NO_AUTOPILOT, 0, 0, ACTIVE);
    send(board, &message);
    mavlink_msg_lta_light_status_pack(SYSTEM, COMPONENT, &message, now_us, (uint32_t)board->sampled, board->overruns,
                                      board->config.sample_rate, board->config.diodes, ADC_BITS, LIGHT_BOARD_DIALECT,
                                      light_board_identity.commit, light_board_identity.vehicle);
    send(board, &message);
}

void light_board_hear(light_board_t *board, const uint8_t *bytes, size_t count, uint64_t now_us)
{
    for (size_t i = 0; i < count; i++) {
        mavlink_status_t status;
        const mavlink_message_t *heard = &board->heard;
        if (mavlink_frame_char_buffer(&board->partial, &board->parser, bytes[i], &board->heard, &status)
                != MAVLINK_FRAMING_OK
            || heard->msgid != MAVLINK_MSG_ID_TIMESYNC || mavlink_msg_timesync_get_tc1(heard) != 0)
            continue;
        mavlink_message_t answer;
        mavlink_msg_timesync_pack(SYSTEM, COMPONENT, &answer, (int64_t)now_us * 1000,
                                  mavlink_msg_timesync_get_ts1(heard));
        send(board, &answer); /* before the rows: what waits here is taken for the link's delay */
    }
}

void light_board_work(light_board_t *board, uint64_t now_us)
{
    if (now_us >= board->next_beat_us) {
        board->next_beat_us = now_us + BEAT_US;
        send_status(board, now_us);
    }
    if (board->config.peak_frequency > 0.0f)
        find_peaks(board);
    else
        send_blocks(board);
}
