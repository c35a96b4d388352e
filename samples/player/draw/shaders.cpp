#include "draw/shaders.h"

#include "blend/heat.h"

namespace pliant::player {
namespace {

constexpr char version_line[] = "#version 330 core\n";

// Of the footprint, in heights of a character: the map's depth from its near to its far plane, how far below the floor it
// starts, and the four heights that it tells apart.
static_assert(footprint_top == 1.3f && footprint_below == 0.02f);
constexpr char footprint_numbers[] = "#define FOOTPRINT_TOP 1.3\n#define FOOTPRINT_BELOW 0.02\n#define LOWEST_HEIGHT 0.02\n"
                                     "#define HEIGHT_FACTOR 2.92\n";

// One triangle that covers the viewport.
constexpr char backdrop_vertex_source[] = R"(
out vec2 place;
void main()
{
    vec2 corner = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
    place = corner;
    gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
})";

// A studio wall, brightest behind the character. Noise of less than one grey level hides banding.
constexpr char backdrop_fragment_source[] = R"(
in vec2 place;
out vec4 colour;
uniform vec2 glow; // where the character stands, 0 to 1
uniform float aspect;
void main()
{
    vec3 wall = mix(vec3(0.80, 0.83, 0.875), vec3(0.93, 0.945, 0.965), smoothstep(0.0, 0.9, place.y));
    float far = length((place - glow) * vec2(aspect, 1.0));
    wall = mix(vec3(0.975, 0.98, 0.985), wall, smoothstep(0.05, 0.85, far));
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    colour = vec4(wall + (noise - 0.5) * 1.6 / 255.0, 1.0);
})";

constexpr char depth_vertex_source[] = R"(
layout(location = 0) in vec3 position;
layout(location = 3) in vec2 texture_place;
layout(location = 4) in vec4 tint;
uniform mat4 matrix;
out vec2 place;
out float tint_alpha;
void main()
{
    place = texture_place;
    tint_alpha = tint.a;
    gl_Position = matrix * vec4(position, 1.0);
})";

// Places that an alpha mask removes cast no shadow. Seen from below (scene.cpp), the colour is the height above the floor:
// shares of four heights, which grow by a factor.
constexpr char depth_fragment_source[] = R"(
in vec2 place;
in float tint_alpha;
uniform sampler2D picture;
uniform float alpha_factor;
uniform float cutoff; // 0: no mask
out vec4 shares;
void main()
{
    if (cutoff > 0.0 && alpha_factor * tint_alpha * texture(picture, place).a < cutoff) discard;
    float height = gl_FragCoord.z * FOOTPRINT_TOP - FOOTPRINT_BELOW;
    float step = clamp(log(max(height, LOWEST_HEIGHT) / LOWEST_HEIGHT) / log(HEIGHT_FACTOR), 0.0, 3.0);
    shares = max(1.0 - abs(step - vec4(0.0, 1.0, 2.0, 3.0)), 0.0);
})";

constexpr char floor_vertex_source[] = R"(
uniform mat4 view_projection;
uniform vec3 centre;
uniform float radius;
out vec3 point;
void main()
{
    vec2 corner = vec2((gl_VertexID & 1) * 2 - 1, (gl_VertexID & 2) - 1);
    point = vec3(centre.x + corner.x * radius, 0.0, centre.z + corner.y * radius);
    gl_Position = view_projection * vec4(point, 1.0);
})";

constexpr char body_vertex_source[] = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 face_sum;
layout(location = 2) in float heat;
layout(location = 3) in vec2 texture_place;
layout(location = 4) in vec4 tint;
uniform mat4 model; // turns and moves, no scale
uniform mat4 view_projection;
uniform bool is_painted;
out vec3 point;
out vec3 direction;
out float warmth;
out vec2 place;
out vec4 paint;
void main()
{
    warmth = heat;
    place = texture_place;
    paint = is_painted ? tint : vec4(1.0);
    vec4 world = model * vec4(position, 1.0);
    point = world.xyz;
    direction = mat3(model) * face_sum * inversesqrt(max(dot(face_sum, face_sum), 1e-30));
    gl_Position = view_projection * world;
})";

// Soft shadows. A light's matrix maps the scene into the unit cube with one scale for all axes, so it also rotates
// directions.
constexpr char shadow_functions[] = R"(
uniform sampler2DArrayShadow shadows;
uniform mat4 light_matrices[LIGHTS];
uniform vec4 lights[LIGHTS]; // direction to the light, share of the dome's brightness (key: 1)

vec2 disc(int i, int count) // evenly over the unit disc (Vogel's spiral)
{
    float angle = float(i) * 2.39996323;
    return sqrt((float(i) + 0.5) / float(count)) * vec2(cos(angle), sin(angle));
}

// How much of a light of angular size `softness` reaches a point with the given normal. Each look-up is compared with the
// depth of the point's tangent plane there, so a wide disc does not shadow the very surface it stands on.
float visibility(int light, vec3 point, vec3 normal, float softness, int taps)
{
    vec3 at = (light_matrices[light] * vec4(point, 1.0)).xyz;
    vec3 turned = normalize(mat3(light_matrices[light]) * normal);
    vec2 slope = -turned.xy / -max(-turned.z, 0.2);
    float sum = 0.0;
    for (int i = 0; i < taps; ++i) {
        vec2 offset = disc(i, taps) * softness;
        float depth = at.z + clamp(dot(slope, offset), -0.06, 0.06) - 0.0025;
        sum += texture(shadows, vec4(at.xy + offset, float(light), min(depth, 0.9999)));
    }
    return sum / float(taps);
}
)";

// The floor shows only its shadows, which darken the backdrop. How much of the sky a surface hides from a place of the floor
// depends on its height z and the distance r: z^2 / (pi (r^2 + z^2)^2) of it for each area. `footprint` holds the lowest
// surface above each place, divided into four heights; for each of them the integral is a sum over places spread with that
// density. Every look-up averages the area that its place stands for, in a mip level: wide shadows are smooth, feet have a
// dark rim.
constexpr char floor_fragment_source[] = R"(
in vec3 point;
out vec4 colour;
uniform vec3 centre;
uniform float radius;
uniform sampler2D footprint;
uniform float footprint_radius; // half the width of the map
uniform float body_height;
uniform float key_softness; // of the key light's shadow, in widths of the shadow map

float hidden_sky()
{
    vec2 at = (point.xz - centre.xz) / footprint_radius * 0.5 + 0.5;
    float texels = float(textureSize(footprint, 0).x), sum = 0.0, high = LOWEST_HEIGHT * body_height;
    for (int k = 0; k < 4; ++k) {
        float z = high / (2.0 * footprint_radius);
        for (int i = 0; i < SKY_TAPS; ++i) {
            float share = (float(i) + 0.5) / float(SKY_TAPS), r = z * sqrt(share / (1.0 - share));
            float angle = float(i) * 2.39996323 + float(k);
            float apart = sqrt(3.14159265 / float(SKY_TAPS)) * (r * r + z * z) / z;
            sum += textureLod(footprint, at + r * vec2(cos(angle), sin(angle)), log2(max(1.4 * apart * texels, 1.0)))[k];
        }
        high *= HEIGHT_FACTOR;
    }
    return min(sum / float(SKY_TAPS), 1.0);
}

void main()
{
    float fade = 1.0 - smoothstep(0.45, 1.0, length(point.xz - centre.xz) / radius);
    if (fade <= 0.0) discard;
    vec3 up = vec3(0.0, 1.0, 0.0);
    float key = visibility(0, point, up, key_softness, KEY_TAPS > 12 ? 2 * KEY_TAPS : KEY_TAPS);
    float shade = 1.0 - 0.36 * key - 0.64 * (1.0 - hidden_sky());
    colour = vec4(0.16, 0.19, 0.27, 0.80 * shade * fade);
})";

// A key light with a soft terminator, a dome of sky lights whose shadows give ambient occlusion, light reflected by the
// floor, a broad Blinn-Phong highlight, which is enough for clay, and a rim light at grazing angles.
constexpr char body_fragment_source[] = R"(
in vec3 point;
in vec3 direction;
in float warmth; // 0 to 1 along heat_colours; negative: none
in vec2 place;
in vec4 paint;
out vec4 colour;
uniform vec4 base_colour;
uniform sampler2D picture;
uniform float cutoff; // below this alpha nothing is drawn; 0: no mask
uniform bool is_blended;
uniform vec3 heat_colours[HEAT_COLOURS];
uniform vec3 eye;
uniform float height; // of the scene
uniform float wire;   // the opacity of an edge; 0: this is a surface

vec3 surface_colour(vec3 painted)
{
    if (warmth < -1.5) { // the reference of distances: hatched
        float stripe = abs(fract((gl_FragCoord.x + gl_FragCoord.y) / 14.0) - 0.5);
        return mix(vec3(0.80, 0.82, 0.80), vec3(0.52, 0.64, 0.56), smoothstep(0.20, 0.30, stripe));
    }
    if (warmth < 0.0) return painted;
    float at = clamp(warmth, 0.0, 1.0) * float(HEAT_COLOURS - 1);
    int low = min(int(at), HEAT_COLOURS - 2);
    return mix(heat_colours[low], heat_colours[low + 1], at - float(low));
}

void main()
{
    if (wire > 0.0) {
        colour = vec4(0.10, 0.13, 0.19, wire);
        return;
    }
    vec4 painted = base_colour * paint * texture(picture, place);
    if (painted.a < cutoff) discard;
    vec3 base = surface_colour(painted.rgb);
    vec3 normal = normalize(gl_FrontFacing ? direction : -direction);
    vec3 view = normalize(eye - point);
    vec3 key_direction = lights[0].xyz;

    float facing = dot(normal, key_direction);
    float key = visibility(0, point, normal, 0.010, KEY_TAPS) * smoothstep(-0.02, 0.12, facing);
    float lit = key * clamp((facing + 0.06) / 1.06, 0.0, 1.0);

    float sky = 0.0, whole = 0.0;
    for (int light = 1; light < LIGHTS; ++light) {
        float cosine = dot(normal, lights[light].xyz);
        whole += lights[light].w * max(lights[light].y, 0.0);
        if (cosine > 0.0) sky += lights[light].w * cosine * visibility(light, point, normal, 0.022, DOME_TAPS);
    }
    sky /= max(whole, 1e-6);
    float near_floor = smoothstep(0.0, 0.35, point.y / height);
    float bounce = (0.5 - 0.5 * normal.y) * mix(0.35, 1.0, near_floor);

    vec3 light = vec3(1.00, 0.95, 0.88) * 1.62 * lit + vec3(0.80, 0.90, 1.06) * 0.50 * sky
        + vec3(0.95, 0.97, 1.0) * 0.30 * bounce + vec3(0.055);
    vec3 shaded = base * light;

    vec3 halfway = normalize(key_direction + view);
    shaded += vec3(0.20) * pow(max(dot(normal, halfway), 0.0), 34.0) * key;
    float grazing = pow(1.0 - clamp(dot(normal, view), 0.0, 1.0), 3.0);
    vec3 rim_direction = normalize(vec3(-key_direction.x, 0.55, -key_direction.z));
    float behind = clamp(0.45 + 0.55 * dot(normal, rim_direction), 0.0, 1.0);
    shaded += (0.35 * base + vec3(0.30, 0.34, 0.40)) * grazing * behind * mix(0.5, 1.0, near_floor);

    // Bright parts roll off instead of clipping (Reinhard with white at 4), then sRGB.
    vec3 mapped = shaded * (1.0 + shaded / 16.0) / (1.0 + 0.55 * shaded);
    colour = vec4(pow(clamp(mapped, 0.0, 1.0), vec3(1.0 / 2.2)), is_blended ? clamp(painted.a, 0.0, 1.0) : 1.0);
})";

} // namespace

ShaderSources shader_sources(int light_count, int key_taps, int dome_taps, int sky_taps)
{
    const std::string version = version_line;
    const std::string numbers = "#define LIGHTS " + std::to_string(light_count) + "\n#define KEY_TAPS "
        + std::to_string(key_taps) + "\n#define DOME_TAPS " + std::to_string(dome_taps) + "\n#define SKY_TAPS "
        + std::to_string(sky_taps) + "\n#define HEAT_COLOURS " + std::to_string(heat_colours.size()) + "\n"
        + footprint_numbers;
    ShaderSources sources;
    sources.backdrop_vertex = version + backdrop_vertex_source;
    sources.backdrop_fragment = version + backdrop_fragment_source;
    sources.depth_vertex = version + depth_vertex_source;
    sources.depth_fragment = version + footprint_numbers + depth_fragment_source;
    sources.floor_vertex = version + floor_vertex_source;
    sources.floor_fragment = version + numbers + shadow_functions + floor_fragment_source;
    sources.body_vertex = version + body_vertex_source;
    sources.body_fragment = version + numbers + shadow_functions + body_fragment_source;
    return sources;
}

} // namespace pliant::player
