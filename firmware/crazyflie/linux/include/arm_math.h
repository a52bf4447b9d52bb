/* In place of ARM's library of matrices: its types; what is compiled here multiplies none. */
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

arm_status arm_mat_trans_f32(const arm_matrix_instance_f32 *from, arm_matrix_instance_f32 *to);
arm_status arm_mat_inverse_f32(const arm_matrix_instance_f32 *from, arm_matrix_instance_f32 *to);
arm_status arm_mat_mult_f32(const arm_matrix_instance_f32 *a, const arm_matrix_instance_f32 *b,
                            arm_matrix_instance_f32 *to);
static inline arm_status arm_sqrt_f32(float32_t in, float32_t *out) {
  *out = sqrtf(in);
  return ARM_MATH_SUCCESS;
}
static inline float32_t arm_sin_f32(float32_t angle) { return sinf(angle); }
static inline float32_t arm_cos_f32(float32_t angle) { return cosf(angle); }
