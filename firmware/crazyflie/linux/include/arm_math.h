// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* In place of ARM's library of matrices: what the Kalman filter uses of it. */
#pragma once

#include <math.h>
#include <stdint.h>

#define PI 3.14159265358979f

typedef float float32_t;
typedef struct {
  uint16_t numRows, numCols;
  float32_t *pData;
} arm_matrix_instance_f32;
typedef enum { ARM_MATH_SUCCESS = 0, ARM_MATH_SIZE_MISMATCH = -3 } arm_status;

static inline arm_status arm_mat_trans_f32(const arm_matrix_instance_f32 *from,
                                           arm_matrix_instance_f32 *to) {
  for (int row = 0; row < from->numRows; row++) {
    for (int column = 0; column < from->numCols; column++) {
      to->pData[column * from->numRows + row] = from->pData[row * from->numCols + column];
    }
  }
  return ARM_MATH_SUCCESS;
}
static inline arm_status arm_mat_mult_f32(const arm_matrix_instance_f32 *a,
                                          const arm_matrix_instance_f32 *b,
                                          arm_matrix_instance_f32 *to) {
  for (int row = 0; row < a->numRows; row++) {
    for (int column = 0; column < b->numCols; column++) {
      float32_t sum = 0.0f;
      for (int k = 0; k < a->numCols; k++) {
        sum += a->pData[row * a->numCols + k] * b->pData[k * b->numCols + column];
      }
      to->pData[row * b->numCols + column] = sum;
    }
  }
  return ARM_MATH_SUCCESS;
}
static inline arm_status arm_mat_scale_f32(const arm_matrix_instance_f32 *from, float32_t scale,
                                           arm_matrix_instance_f32 *to) {
  for (int k = 0; k < from->numRows * from->numCols; k++) {
    to->pData[k] = scale * from->pData[k];
  }
  return ARM_MATH_SUCCESS;
}
/* Of robust updates by radio beacons alone, which nothing here sends. */
static inline arm_status arm_mat_inverse_f32(const arm_matrix_instance_f32 *from,
                                             arm_matrix_instance_f32 *to) {
  (void)from, (void)to;
  return ARM_MATH_SIZE_MISMATCH;
}
static inline arm_status arm_sqrt_f32(float32_t in, float32_t *out) {
  *out = sqrtf(in);
  return ARM_MATH_SUCCESS;
}
static inline float32_t arm_sin_f32(float32_t angle) { return sinf(angle); }
static inline float32_t arm_cos_f32(float32_t angle) { return cosf(angle); }
