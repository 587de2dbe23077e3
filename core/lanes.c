// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Angle. Let a <= b be |y| and |x|. Where a/b > tan(pi/8), atan(a/b) = pi/4 - atan t with t = (b - a)/(b +
// a), which leaves t <= tan(pi/8) for
//   atan t = t + t u P(u),  u = t^2.
// Power, by way of the logarithm: v = m 2^k with m in [sqrt(1/2), sqrt(2)), f = (m - 1)/(m + 1), u = f^2,
//   log v = k log 2 + 2 f + f u L(u),
// and exp z = 2^k (1 + r + r^2 E(r)), r = z - k log 2 in [-log 2 / 2, log 2 / 2].
// P, L and E interpolate (atan(t)/t - 1)/u, (log(m)/f - 2)/u and (exp(r) - 1 - r)/r^2 at the zeros of
// Chebyshev polynomials; what that leaves is below 2e-17 of the function. They are summed in pairs of terms
// (Estrin 1960), which wait less for one another.
#include "core/lanes.h"

#include "core/vec3.h"
#include "core/wide.h"

#include <float.h>
#include <stdint.h>
#include <string.h>

RUGA_WIDE_PART uint64_t bits_of(double a) {
    uint64_t bits;
    memcpy(&bits, &a, sizeof bits);
    return bits;
}

RUGA_WIDE_PART double from_bits(uint64_t bits) {
    double a;
    memcpy(&a, &bits, sizeof a);
    return a;
}

RUGA_WIDE static void set_angles(int count, const double* restrict y, const double* restrict x,
                                 double* restrict angle) {
    const double split = 0.41421356237309503;                                // tan(pi/8)
    const double quarter = 0.7853981633974483, rest = 3.061616997868383e-17; // of pi: their sum
    const double most = DBL_MAX / 4;
    for (int i = 0; i < count; i++) {
        double ax = fabs(x[i]), ay = fabs(y[i]);
        ax = ax > most ? most : ax; // where they have overflowed, an angle all the same
        ay = ay > most ? most : ay;
        double a = ay < ax ? ay : ax, b = ay < ax ? ax : ay;
        double high = a > split * b ? 1 : 0, steep = ay > ax ? 1 : 0, left = x[i] < 0 ? 1 : 0;
        double top = high != 0 ? b - a : a, bottom = high != 0 ? b + a : b;
        double t = top / (bottom == 0 ? 1 : bottom), u = t * t, u2 = u * u, u4 = u2 * u2;
        double p = (-0.33333333333333331 + 0.19999999999995521 * u) +
                   u2 * (-0.14285714284666542 + 0.11111111015256361 * u) +
                   u4 * ((-0.090909045781239012 + 0.076921831908260865 * u) +
                         u2 * (-0.066645114473819392 + 0.058581489128021372 * u)) +
                   u4 * u4 * (-0.050854497379398789 + 0.039231658295576184 * u - 0.019176887119048774 * u2);
        // The angle is `turns` quarters of pi, plus or minus atan t.
        double turns = high, sign = 1 - 2 * high;
        turns = steep != 0 ? 2 - turns : turns;
        turns = left != 0 ? 4 - turns : turns;
        sign *= (1 - 2 * steep) * (1 - 2 * left);
        double positive = turns * quarter + (sign * (t + t * (u * p)) + turns * rest);
        angle[i] = copysign(positive, y[i]);
    }
}

void ruga_lanes_angle(int count, const double* y, const double* x, double* angle) {
    set_angles(count, y, x, angle);
}

RUGA_WIDE static void set_powers(int count, const double* restrict value, double power,
                                 double* restrict result) {
    const double log2_high = 0.69314718055989033,
                 log2_low = 5.4979230187083712e-14; // their sum; high: 42 bits
    const uint64_t root_half = 0x3fe6a09e667f3bcdu, one = 0x3ff0000000000000u, magic = 0x4330000000000000u;
    const double round = 0x1.8p52; // added and taken away again it leaves the nearest integer
    for (int i = 0; i < count; i++) {
        uint64_t bits = bits_of(value[i]), exponent = (bits - root_half + one) >> 52; // k + 1023
        double k = from_bits(magic | exponent) - (0x1p52 + 1023);
        double m = from_bits(bits - (exponent << 52) + one);
        double f = (m - 1) / (m + 1), u = f * f, u2 = u * u;
        double l = (0.66666666666666696 + 0.39999999999899505 * u) +
                   u2 * (0.28571428625975487 + 0.22222211134795081 * u) +
                   u2 * u2 * (0.18182889125261725 + 0.15331721600555942 * u + 0.14616449685044641 * u2);
        double z = power * (k * log2_high + (k * log2_low + (2 * f + f * (u * l))));
        double shifted = z * 1.4426950408889634 + round, n = shifted - round;
        double r = (z - n * log2_high) - n * log2_low, r2 = r * r, r4 = r2 * r2;
        double e = (0.50000000000000011 + 0.16666666666666669 * r) +
                   r2 * (0.041666666666624164 + 0.008333333333330065 * r) +
                   r4 * ((0.0013888888917196719 + 0.00019841269863040545 * r) +
                         r2 * (2.4801521322368448e-05 + 2.7557268480309837e-06 * r)) +
                   r4 * r4 * (2.7620075880100385e-07 + 2.5100375832651221e-08 * r);
        result[i] = from_bits(bits_of(1 + (r + r2 * e)) + (bits_of(shifted) << 52));
    }
}

void ruga_lanes_power(int count, const double* value, double power, double* result) {
    set_powers(count, value, power, result);
}
