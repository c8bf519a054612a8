// SPDX-License-Identifier: Apache-2.0
// Marks the names that a shared libstandoff exports. All others have hidden visibility (cmake/components.cmake).
#pragma once

/// Marks every public function that the library defines, and every class that has such members or is thrown. Structs of
/// values and inline functions need no mark.
#if defined(STANDOFF_STATIC) || !defined(__GNUC__)
#define STANDOFF_API  // a shared library that links standoff statically exports none of its names
#else
#define STANDOFF_API __attribute__((visibility("default")))
#endif
