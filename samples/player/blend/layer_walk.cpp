#include "blend/layer_walk.h"

#include <algorithm>
#include <random>

namespace pliant::player {
namespace {

using Row = std::vector<double>;

constexpr std::size_t rows_per_key = 24; // 0.8 seconds
constexpr std::size_t fewest_mixtures = 6, most_mixtures = 12;

Row initial_weights(const std::vector<WeightRange>& layers)
{
    Row weights;
    for (const WeightRange& layer : layers) weights.push_back(layer.initial);
    return weights;
}

// Uniform in [0, 1). The distributions of the standard library differ between its implementations.
double uniform(std::mt19937& random) { return static_cast<double>(random()) / 4294967296.0; }

Row mixture(const std::vector<WeightRange>& layers, std::mt19937& random)
{
    Row weights = initial_weights(layers);
    const std::size_t active = std::min<std::size_t>(layers.size(), 2 + random() % 3);
    std::vector<std::size_t> left(layers.size());
    for (std::size_t k = 0; k < left.size(); ++k) left[k] = k;
    for (std::size_t i = 0; i < active; ++i) {
        std::swap(left[i], left[i + random() % (left.size() - i)]);
        const WeightRange& layer = layers[left[i]];
        const bool down = layer.low < layer.initial && uniform(random) < 0.5;
        weights[left[i]] += (0.35 + 0.65 * uniform(random)) * ((down ? layer.low : layer.high) - layer.initial);
    }
    return weights;
}

} // namespace

std::vector<Row> layer_mixtures(const std::vector<WeightRange>& layers)
{
    std::mt19937 random(20261203);
    std::vector<Row> rows;
    const std::size_t count = std::clamp(layers.size(), fewest_mixtures, most_mixtures);
    for (std::size_t i = 0; i < count; ++i) rows.push_back(mixture(layers, random));
    return rows;
}

std::vector<Row> layer_keys(const std::vector<WeightRange>& layers)
{
    const Row initial = initial_weights(layers);
    std::vector<Row> keys;
    for (std::size_t k = 0; k < layers.size(); ++k) {
        for (double end : { layers[k].high, layers[k].low }) {
            if (end == layers[k].initial) continue;
            keys.push_back(initial);
            keys.back()[k] = end;
        }
        keys.push_back(initial);
    }
    const std::vector<Row> mixtures = layer_mixtures(layers);
    keys.insert(keys.end(), mixtures.begin(), mixtures.end());
    return keys;
}

WeightPath layer_walk(const std::vector<WeightRange>& layers)
{
    std::vector<Row> keys = layer_keys(layers), rows;
    keys.insert(keys.begin(), initial_weights(layers));
    for (std::size_t i = 0; i < keys.size(); ++i) {
        const Row &from = keys[i], &to = keys[(i + 1) % keys.size()];
        for (std::size_t row = 0; row < rows_per_key; ++row) {
            const double s = static_cast<double>(row) / rows_per_key, t = s * s * (3.0 - 2.0 * s);
            rows.push_back(from);
            for (std::size_t k = 0; k < from.size(); ++k) rows.back()[k] += t * (to[k] - from[k]);
        }
    }
    return WeightPath(std::move(rows));
}

} // namespace pliant::player
