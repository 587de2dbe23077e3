// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The border between C++ libraries and C: no exception crosses it. Use in every function of a shim:
//     RUGA_SHIM_BEGIN
//     ... convert, one library call, convert back ...
//     return RUGA_OK;
//     RUGA_SHIM_END("name of the library")
#ifndef RUGA_CORE_SHIM_HPP
#define RUGA_CORE_SHIM_HPP

#include <exception>
#include <new>

extern "C" {
#include "core/status.h"
}

// Thrown where a C callback returned a status: handed back as it is at the border.
struct ruga_status_thrown {
    ruga_status status;
};

#define RUGA_SHIM_BEGIN try {
#define RUGA_SHIM_END(library)                                                                               \
    }                                                                                                        \
    catch (const ruga_status_thrown& thrown) {                                                               \
        return thrown.status;                                                                                \
    }                                                                                                        \
    catch (const std::bad_alloc&) {                                                                          \
        return ruga_fail(RUGA_NO_MEMORY, "out of memory in %s", library);                                    \
    }                                                                                                        \
    catch (const std::exception& thrown) {                                                                   \
        return ruga_fail(RUGA_LIBRARY, "%s failed: %s", library, thrown.what());                             \
    }                                                                                                        \
    catch (...) {                                                                                            \
        return ruga_fail(RUGA_LIBRARY, "%s failed", library);                                                \
    }

#endif
