// The colours of panels and captions. Every text has a contrast of at least 4.5 : 1 with what it stands on, as WCAG computes
// it, whatever is behind the panel: test_player_view.cpp.
#pragma once

#include <cstdint>

namespace pliant::player {

// As Dear ImGui packs them.
constexpr std::uint32_t rgba(std::uint32_t red, std::uint32_t green, std::uint32_t blue, std::uint32_t alpha = 255)
{
    return red | green << 8 | blue << 16 | alpha << 24;
}

// Texts.
inline constexpr std::uint32_t ink = rgba(34, 42, 56), faint_ink = rgba(80, 91, 110), elastic_ink = rgba(164, 54, 22),
                               linear_ink = rgba(66, 88, 126), unreduced_ink = rgba(32, 98, 68),
                               error_ink = rgba(150, 40, 20);
// Texts on a button in one of the colours above.
inline constexpr std::uint32_t white_ink = rgba(255, 255, 255);

// What texts stand on: panels and the plates of captions, buttons on a panel, fields.
inline constexpr std::uint32_t panel = rgba(255, 255, 255, 222), error_panel = rgba(255, 236, 230, 240),
                               button = rgba(40, 52, 76, 18), hovered_button = rgba(40, 52, 76, 36),
                               pressed_button = rgba(40, 52, 76, 56), field = rgba(234, 238, 245);

// No texts.
inline constexpr std::uint32_t sand_ink = rgba(206, 184, 142), border = rgba(255, 255, 255, 217);

} // namespace pliant::player
