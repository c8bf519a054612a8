// SPDX-License-Identifier: Apache-2.0
// The colors of pictures.
#pragma once

namespace standoff {

enum class Colormap {
  viridis,    ///< from dark blue (least) over green to yellow (greatest): visually uniform, readable in grey
  thesis,     ///< from red (least) over green to blue (greatest), as the 2008 thesis draws its slices
  diverging,  ///< blue inside, white at 0, red outside; equal distances are equally dark on both sides
  automatic,  ///< diverging if the field has a sign, else viridis
};

enum class Background {
  white,        ///< dark words on white
  dark,         ///< light words on a dark grey
  transparent,  ///< dark words on nothing; pictures in three dimensions alone
};

}  // namespace standoff
