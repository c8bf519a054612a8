// SPDX-License-Identifier: Apache-2.0
// What to do when the output file already exists.
#pragma once

namespace standoff {

enum class Existing {
  replace,  ///< replace it
  keep,     ///< fail with Error{output} if the file exists or appears before the write completes; devices and pipes are
            ///< always written
};

}  // namespace standoff
