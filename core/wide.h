// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// RUGA_WIDE before a function that is one hot loop: it is compiled twice, and the processor's wider registers
// (AVX2) are used where it has them. Without fused operations, so that both give the same bits. The function
// is static: GCC 12 exports what is not, whatever its visibility.
// RUGA_WIDE_PART before what such a function calls in its loop: it becomes part of it.
#ifndef RUGA_CORE_WIDE_H
#define RUGA_CORE_WIDE_H

#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__SANITIZE_ADDRESS__)
#define RUGA_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define RUGA_WIDE
#endif

#ifdef __GNUC__
#define RUGA_WIDE_PART static inline __attribute__((always_inline))
#else
#define RUGA_WIDE_PART static inline
#endif

#endif
