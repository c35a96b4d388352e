#include "input/gltf/animation.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pliant {
namespace {

enum class Interpolation { step, linear, cubic };

// Keys of one channel. A key has `width` numbers; with cubic splines three times as many: in-tangent, value, out-tangent.
struct Sampler {
    std::vector<double> times;
    GltfNumbers values; // rows of one accessor element
    Interpolation interpolation = Interpolation::linear;
    std::size_t width = 0;

    const double* key(std::size_t i) const
    {
        const std::size_t stride = interpolation == Interpolation::cubic ? 3 * width : width;
        return values.data() + i * stride + (interpolation == Interpolation::cubic ? width : 0);
    }
    const double* in_tangent(std::size_t i) const { return key(i) - width; }
    const double* out_tangent(std::size_t i) const { return key(i) + width; }
};

std::vector<double> read_times(const GltfDocument& document, const GltfValue& input, GltfAllowance& allowance)
{
    allowance.take_all_of(input);
    const GltfNumbers numbers = read_numbers(document, input, { 1 });
    if (numbers.rows() == 0) input.fail(2326, "has no keys");
    for (Eigen::Index i = 0; i < numbers.rows(); ++i)
        if (!std::isfinite(numbers(i, 0)) || (i > 0 && !(numbers(i, 0) > numbers(i - 1, 0))))
            input.fail(2326, fmt::format("the times of the keys must increase, that of key {} does not", i));
    return { numbers.data(), numbers.data() + numbers.size() };
}

// `width`: numbers of a value; `components`: of an element of the accessor.
Sampler read_sampler(const GltfDocument& document, const GltfValue& sampler, std::size_t width, int components,
                     GltfAllowance& allowance)
{
    Sampler out;
    out.width = width;
    out.times = read_times(document, sampler["input"], allowance);
    const std::string name = sampler["interpolation"].text_or("LINEAR");
    if (name != "LINEAR" && name != "STEP" && name != "CUBICSPLINE")
        sampler["interpolation"].fail(2326, "STEP, LINEAR or CUBICSPLINE expected");
    out.interpolation = name == "STEP" ? Interpolation::step
        : name == "LINEAR"             ? Interpolation::linear
                                       : Interpolation::cubic;
    allowance.take_all_of(sampler["output"]);
    out.values = read_numbers(document, sampler["output"], { components });
    const std::size_t per_key = out.interpolation == Interpolation::cubic ? 3 * width : width;
    if (static_cast<std::size_t>(out.values.size()) != out.times.size() * per_key)
        sampler["output"].fail(
            2326, fmt::format("has {} numbers for {} keys of {}", out.values.size(), out.times.size(), per_key));
    if (!out.values.allFinite()) sampler["output"].fail(2326, "has numbers that are not finite");
    return out;
}

// The key before a time, and how far on the way to the next one it is: 0 at the key, 1 at the next.
struct Place {
    std::size_t key = 0;
    double way = 0;
};

Place find_place(const std::vector<double>& times, double seconds)
{
    const double latest = seconds + time_slack(seconds);
    const std::size_t after = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), latest) - times.begin());
    if (after == 0) return { 0, 0 };
    if (after == times.size()) return { times.size() - 1, 0 };
    return { after - 1, std::max((seconds - times[after - 1]) / (times[after] - times[after - 1]), 0.0) };
}

// glTF 2.0, appendix C.5: Hermite splines whose tangents are per second.
std::vector<double> cubic(const Sampler& s, const Place& place)
{
    const double t = place.way, t2 = t * t, t3 = t2 * t, span = s.times[place.key + 1] - s.times[place.key];
    const double *from = s.key(place.key), *to = s.key(place.key + 1);
    const double *out = s.out_tangent(place.key), *in = s.in_tangent(place.key + 1);
    std::vector<double> value(s.width);
    for (std::size_t c = 0; c < s.width; ++c)
        value[c] = (2 * t3 - 3 * t2 + 1) * from[c] + span * (t3 - 2 * t2 + t) * out[c] + (3 * t2 - 2 * t3) * to[c]
            + span * (t3 - t2) * in[c];
    return value;
}

std::vector<double> sample(const Sampler& s, double seconds, bool is_rotation)
{
    const Place place = find_place(s.times, seconds);
    const double* from = s.key(place.key);
    if (place.way == 0 || s.interpolation == Interpolation::step) return { from, from + s.width };
    if (s.interpolation == Interpolation::cubic) return cubic(s, place);
    const double* to = s.key(place.key + 1);
    if (is_rotation) {
        const Eigen::Map<const Eigen::Quaterniond> a(from), b(to);
        const Eigen::Quaterniond between = a.normalized().slerp(place.way, b.normalized());
        return { between.x(), between.y(), between.z(), between.w() };
    }
    std::vector<double> value(s.width);
    for (std::size_t c = 0; c < s.width; ++c) value[c] = from[c] + place.way * (to[c] - from[c]);
    return value;
}

void apply_channel(const GltfScene& scene, const GltfValue& animation, const GltfValue& channel, double seconds,
                   GltfAllowance& allowance, GltfState& state)
{
    constexpr std::uint64_t numbers_of_channel = 600; // what finding its parts costs
    allowance.take(channel, numbers_of_channel);
    const GltfDocument& document = *scene.document;
    const GltfValue target = channel["target"];
    if (!target["node"].exists()) return; // allowed: an extension moves something else
    const std::size_t node = target["node"].index(scene.nodes.size(), "nodes");
    const std::string path = target["path"].text();
    const GltfValue samplers = animation["samplers"];
    const GltfValue sampler = samplers.at(channel["sampler"].index(samplers.size(), "samplers"));
    if (path == "weights") {
        std::vector<double>& weights = state.weights[node];
        if (!weights.empty())
            weights = sample(read_sampler(document, sampler, weights.size(), 1, allowance), seconds, false);
        return; // without a mesh that is drawn there is nothing to do
    }
    if (path != "translation" && path != "rotation" && path != "scale") return; // an extension's
    if (scene.nodes[node].has_matrix)
        target.fail(2326, fmt::format("moves node {}, which has a matrix", node), "export with separate rotations");
    const bool is_rotation = path == "rotation";
    const Sampler keys = read_sampler(document, sampler, is_rotation ? 4 : 3, is_rotation ? 4 : 3, allowance);
    const std::vector<double> value = sample(keys, seconds, is_rotation);
    GltfTransform& transform = state.transforms[node];
    if (path == "translation") transform.translation = { value[0], value[1], value[2] };
    if (path == "scale") transform.scale = { value[0], value[1], value[2] };
    if (!is_rotation) return;
    const Eigen::Quaterniond rotation(value[3], value[0], value[1], value[2]);
    if (!(rotation.norm() > 1e-6)) sampler["output"].fail(2326, "has a rotation of length 0"); // files round to 1e-6 at best
    transform.rotation = rotation.normalized();
}

} // namespace

std::vector<std::string> animation_names(const GltfDocument& document)
{
    std::vector<std::string> names;
    const GltfValue animations = document["animations"];
    for (std::size_t i = 0; i < animations.size(); ++i) names.push_back(animations.at(i)["name"].text_or(""));
    return names;
}

GltfState animated_state(const GltfScene& scene, std::size_t animation, double seconds, GltfAllowance& allowance)
{
    GltfState state = scene.rest;
    const GltfValue value = (*scene.document)["animations"].at(animation);
    const GltfValue channels = value["channels"];
    for (std::size_t i = 0; i < channels.size(); ++i) apply_channel(scene, value, channels.at(i), seconds, allowance, state);
    return state;
}

double animation_end(const GltfDocument& document, std::size_t animation, GltfAllowance& allowance)
{
    const GltfValue samplers = document["animations"].at(animation)["samplers"];
    double end = 0;
    for (std::size_t i = 0; i < samplers.size(); ++i)
        end = std::max(end, read_times(document, samplers.at(i)["input"], allowance).back());
    return end;
}

} // namespace pliant
