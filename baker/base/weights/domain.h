// Where the weights of a character lie: of averages in a simplex, of layers in a box.
#pragma once

#include "base/weights/sampling.h"
#include "base/weights/weights.h"

namespace pliant {

// The two kinds of blend. Averages: a weight per pose, none negative. Layers: the poses after pose 0 are layers on it, each
// with a weight of its own.
enum class Blend { average, layers };

// Of the weight of a layer; low < high, low <= 0 <= high.
struct WeightRange {
    double low = 0, high = 1;
    double initial = 0; // the weight that a file starts with
};

class WeightDomain {
public:
    // The simplex over so many poses.
    static WeightDomain simplex(std::size_t pose_count) { return WeightDomain(pose_count, {}); }
    // One layer for each range.
    static WeightDomain box(std::vector<WeightRange> ranges)
    {
        const std::size_t count = ranges.size();
        return WeightDomain(count, std::move(ranges));
    }

    bool is_box() const { return !ranges_.empty(); }
    Blend blend() const { return is_box() ? Blend::layers : Blend::average; }
    std::size_t size() const { return size_; } // weights
    // Of layers, or of many poses: it is not filled, mixtures of few of them count most.
    bool is_wide() const { return is_box() || size_ > few_poses; }
    const std::vector<WeightRange>& ranges() const { return ranges_; }

    // Weights that somebody gave: of averages divided by their sum. Throws as normalized_weights() and layer_weights().
    Weights from(const std::vector<double>& values) const;

    // Equal weights, or no layer.
    Weights centre() const;

    // One of a mixed bag, by index: of a simplex mixed_weights(); of a box in turn a single layer, a pair, twice a sparse
    // mixture (of two layers a single one), a dense one and a corner.
    Weights draw(Random& random, std::size_t index) const;
    std::vector<Weights> draw_all(std::uint64_t seed, std::size_t count) const;

    // Whether a tolerance is meant for blends at w: of many layers for sparse mixtures only, since all of them at once
    // seldom make a shape.
    bool is_counted(const Weights& w) const;
    // The first counted ones of draw_all().
    std::vector<Weights> draw_counted(std::uint64_t seed, std::size_t count) const;

    // What kind of mixture it is: "uniform", "edge", "corner" by the index of draw(), or of layers by the weights
    // themselves.
    const char* kind_of(const Weights& w, std::size_t index) const;

    // Weights that cover the domain: those of the poses, the centre, then `count` of a mixed bag. The same for the same
    // seed.
    std::vector<std::vector<float>> covering(std::size_t count, std::uint64_t seed) const;

    // Mixtures of layers: `count` of them anywhere in their ranges, or all of them at an end.
    Weights mixture(Random& random, std::size_t count) const;
    Weights corner(Random& random) const;
    // A layer at an end of its range, alone: the one farther from 0.
    double full(std::size_t layer) const;

private:
    WeightDomain(std::size_t size, std::vector<WeightRange> ranges)
        : size_(size)
        , ranges_(std::move(ranges))
    {
    }

    std::size_t size_;
    std::vector<WeightRange> ranges_;
};

} // namespace pliant
