// SPDX-License-Identifier: Apache-2.0
// Words on pictures.
#pragma once

#include <string_view>

#include "render/image.h"

namespace standoff {

/// Letters are 5 x 7 dots, 6 dots apart; a dot is kTextDot pixels on each side.
inline constexpr int kTextDot = 2;
inline constexpr int kTextHeight = 7 * kTextDot;

/// The width of a text in pixels.
int text_width(std::string_view text);
/// Draws a text (ASCII; other bytes as '?') whose top left corner is (x, y). What lies outside the picture is cut off.
void draw_text(Image& image, int x, int y, std::string_view text, Color color);

}  // namespace standoff
