// SPDX-License-Identifier: Apache-2.0
// Which names a shared libstandoff exports: all else is compiled hidden (cmake/components.cmake).
#pragma once

/// Marks every function that the library defines, and every class that has such members or is thrown. Structs of values
/// and inline functions need no mark.
#if defined(STANDOFF_STATIC) || !defined(__GNUC__)
#define STANDOFF_API  // a shared library that takes standoff in, as an archive, exports nothing of it
#else
#define STANDOFF_API __attribute__((visibility("default")))
#endif
