// The shaders of the scene, GLSL 3.30 core.
#pragma once

#include <string>

namespace pliant::player {

// Sources with the numbers of lights and of samples per shadow filled in.
struct ShaderSources {
    std::string backdrop_vertex, backdrop_fragment;
    std::string depth_vertex, depth_fragment;
    std::string floor_vertex, floor_fragment;
    std::string body_vertex, body_fragment;
};

// The map of what is above the floor, in heights of a character: its depth, and how far below the floor it starts.
inline constexpr float footprint_top = 1.3f, footprint_below = 0.02f;

// light_count: the key light and the lights of the dome. key_taps, dome_taps: samples per shadow. sky_taps: samples of the
// footprint at each of its heights.
ShaderSources shader_sources(int light_count, int key_taps, int dome_taps, int sky_taps);

} // namespace pliant::player
