/* Elementary functions for vector loops: no branches, no tables, plain IEEE single precision. Ours and not libm's so that
   loops vectorise and a blend does not depend on whose libm the platform has. tests/runtime/test_lane_math.c holds them
   against double precision. */
#ifndef PLIANT_LANE_MATH_H
#define PLIANT_LANE_MATH_H

#include "internal.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

/* pi/2, pi/4 */
#define PLIANT_HALF_PI 1.57079637f
#define PLIANT_QUARTER_PI 0.785398185f

static PLIANT_INLINE uint32_t pliant_float_bits(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static PLIANT_INLINE float pliant_bits_float(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* atan2(y, x) to 3 ulp; atan2(0, 0) is not a number, which an evaluation treats as a refused point (libm's answer, 0, would
   hide a collapsed hinge). The arguments' squares are not formed: any size will do, but at least one must be normal.
   Polynomial: Cephes atanf on [0, tan(pi/8)]. */
static PLIANT_INLINE float pliant_atan2(float y, float x)
{
    const float ay = fabsf(y), ax = fabsf(x);
    const float small = ay < ax ? ay : ax;
    const float large = ay < ax ? ax : ay;
    const int upper = small > 0.414213562f * large; /* tan(pi/8): beyond it turn by pi/4 */
    const float numerator = upper ? small - large : small;
    const float denominator = upper ? small + large : large;
    const float t = numerator / denominator;
    const float s = t * t;
    float angle
        = (((8.05374449538e-2f * s - 1.38776856032e-1f) * s + 1.99777106478e-1f) * s - 3.33329491539e-1f) * s * t + t;
    angle = upper ? PLIANT_QUARTER_PI + angle : angle;
    angle = ay > ax ? PLIANT_HALF_PI - angle : angle;
    angle = x < 0.0f ? 2.0f * PLIANT_HALF_PI - angle : angle;
    return y < 0.0f ? -angle : angle;
}

/* angle minus the multiple of 2 pi that brings it nearest to 0. Exact reduction (Cody and Waite) for the few turns that
   occur; beyond 2^22 turns the answer is finite and meaningless. */
static PLIANT_INLINE float pliant_wrap_angle(float angle)
{
    /* Adding and subtracting 1.5 * 2^23 rounds to the nearest integer, without the library call that SSE2 lacks. */
    const float turns = (angle * 0.159154943f + 12582912.0f) - 12582912.0f;
    return (angle - turns * 6.28125f) - turns * 1.93530717958e-3f; /* the sum is 2 pi; the first product is exact */
}

/* log(1 + u) - u for u > -1, to 8 ulp (3 for |u| < 0.29) also where it is tiny: near 0 the value is -u^2/2 and no leading
   digits are subtracted. For u <= -1 the answer is finite and meaningless; callers test. Polynomial: Cephes logf,
   log(1+x) - x on sqrt(1/2)-1 .. sqrt(2)-1. */
static PLIANT_INLINE float pliant_log1p_minus(float u)
{
    /* 1 + u = 2^exponent * m with m in [sqrt(1/2), sqrt(2)): the exponent is read where the bits of sqrt(1/2) carry over. */
    const float v = 1.0f + u;
    const int32_t offset = (int32_t)(pliant_float_bits(v) - 0x3F3504F3u);
    const int32_t exponent = offset >> 23;
    const float m = pliant_bits_float(pliant_float_bits(v) - ((uint32_t)exponent << 23));
    const float e = (float)exponent;
    const float x = exponent == 0 ? u : m - 1.0f; /* u itself: v has lost its last digits */
    const float s = x * x;
    float p = 7.0376836292e-2f;
    p = p * x - 1.1514610310e-1f;
    p = p * x + 1.1676998740e-1f;
    p = p * x - 1.2420140846e-1f;
    p = p * x + 1.4249322787e-1f;
    p = p * x - 1.6668057665e-1f;
    p = p * x + 2.0000714765e-1f;
    p = p * x - 2.4999993993e-1f;
    p = p * x + 3.3333331174e-1f;
    const float series = p * x * s - 0.5f * s; /* log(1+x) - x */
    const float rest = exponent == 0 ? 0.0f : (x - u) + e * 0.693147182f;
    return series + rest;
}

/* exp(x) - 1 to 2 ulp for |x| <= 80, also where it is tiny; beyond that the answer is meaningless, not a number if x is.
   Polynomial: Cephes expf on |x| <= log(2)/2. */
static PLIANT_INLINE float pliant_expm1(float x)
{
    /* As in pliant_wrap_angle. The last bits of the shifted number are those of the integer: no conversion, which
       processors do differently for what is not a number. */
    const float shifted = x * 1.44269504f + 12582912.0f;
    const float n = shifted - 12582912.0f;
    const float r = (x - n * 0.693359375f) + n * 2.12194440e-4f;
    const float power = pliant_bits_float((pliant_float_bits(shifted) << 23) + 0x3F800000u);
    float p = 1.9875691500e-4f;
    p = p * r + 1.3981999507e-3f;
    p = p * r + 8.3334519073e-3f;
    p = p * r + 4.1665795894e-2f;
    p = p * r + 1.6666665459e-1f;
    p = p * r + 5.0000001201e-1f;
    return power * (p * (r * r) + r) + (power - 1.0f);
}

/* sinh(k)/k to 3 ulp for 0 <= k <= 80, given exp(k); 1 at 0. A series where the difference of exponentials would cancel. */
static PLIANT_INLINE float pliant_sinh_ratio(float k, float exp_k)
{
    const float s = k * k;
    const float series = 1.0f + s * (1.66666667e-1f + s * (8.33333333e-3f + s * (1.98412698e-4f + s * 2.75573192e-6f)));
    const float quotient = (exp_k - 1.0f / exp_k) / (k + k);
    return k < 1.0f ? series : quotient;
}

/* Cube root of v > 0 to 1.5 ulp. For other v the answer is meaningless; callers test. A third of the bits is the root to 4 %
   (Kahan), each step of Halley cubes the error and divides it by 1.5. */
static PLIANT_INLINE float pliant_cbrt(float v)
{
    const float third = (float)(int32_t)pliant_float_bits(v) * 0.333333343f;
    float k = pliant_bits_float((uint32_t)(int32_t)(third + 709958130.0f));
    for (int step = 0; step < 2; ++step) {
        const float cube = k * k * k;
        k += k * ((v - cube) / (cube + cube + v));
    }
    return k;
}

#endif
