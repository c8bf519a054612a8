// What a file that is already there means to whoever writes one of its name.
#pragma once

namespace standoff {

enum class Existing {
  replace,  ///< the new one takes its place
  keep,  ///< it stays, also when it has appeared only during the writing: Error{output}. Devices and pipes are written
};

}  // namespace standoff
