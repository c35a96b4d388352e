#include "output/export/pose_table.h"

#include "output/asset/reachable.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pliant {

namespace {

constexpr std::size_t tried_count = 1200, fresh_count = 200;
constexpr std::uint64_t tried_seed = 179424673, fresh_seed = 86028121;
constexpr std::size_t most_centres = 200, centres_a_round = 8;
constexpr double wanted_mean = 2e-4;      // of the diagonal, over the blends that centres are taken from
constexpr double nearest_in_round = 0.05; // weights that are added together are apart: one often mends its neighbours
constexpr double centre_digits = 1e4, coefficient_digits = 1e6;

double rounded(double value, double digits) { return std::round(value * digits) / digits; }

struct Blends {
    std::vector<Weights> weights; // of the blends, as a script has them: those of averages divided by their sum
    Eigen::MatrixXd morphs;       // weights of targets, d x blends
    bool has_layers;
};

Weights as_given(const std::vector<float>& weights, bool has_layers)
{
    const Weights w = Eigen::Map<const Eigen::VectorXf>(weights.data(), Eigen::Index(weights.size())).cast<double>();
    return has_layers ? w : Weights(w / w.sum());
}

Blends blends_at(RuntimeBlender& blender, const MorphMesh& mesh, std::size_t count, std::uint64_t seed)
{
    Blends blends { {}, {}, blender.domain().is_box() };
    std::vector<std::vector<float>> solved = blender.domain().covering(count, seed);
    for (std::vector<float>& weights : solved) {
        for (float& w : weights) w = float(rounded(w, centre_digits));
        blends.weights.push_back(as_given(weights, blends.has_layers));
    }
    const Eigen::MatrixXf q = blend_coordinates(blender, solved);
    blends.morphs.resize(q.rows(), q.cols());
    for (Eigen::Index i = 0; i < q.cols(); ++i) blends.morphs.col(i) = mesh.weights(q.col(i)).cast<double>();
    return blends;
}

// The widest side of the box around the centres; no less than 1.
double extent_of(const std::vector<Weights>& centres)
{
    Weights low = centres[0], high = centres[0];
    for (const Weights& w : centres) {
        low = low.cwiseMin(w);
        high = high.cwiseMax(w);
    }
    return std::max(1.0, (high - low).maxCoeff());
}

// Coefficients are multiplied by cubes of distances: for weights up to ten they are a thousandth as large, and need three
// digits more.
void round_coefficients(RadialFunction& function)
{
    const double digits = coefficient_digits * std::pow(10, std::ceil(3 * std::log10(extent_of(function.centres))));
    for (double& x : function.coefficients.reshaped()) x = rounded(x, digits);
}

RadialFunction fit(const Blends& blends, const std::vector<std::size_t>& centres)
{
    std::vector<Weights> places;
    Eigen::MatrixXd values(blends.morphs.rows(), Eigen::Index(centres.size()));
    for (std::size_t i = 0; i < centres.size(); ++i) {
        Weights w = blends.weights[centres[i]];
        for (double& x : w) x = rounded(x, centre_digits);
        places.push_back(w);
        values.col(Eigen::Index(i)) = blends.morphs.col(Eigen::Index(centres[i]));
    }
    RadialFunction function = fit_radial_function(places, values, blends.has_layers);
    round_coefficients(function);
    return function;
}

Eigen::MatrixXd differences(const RadialFunction& function, const Blends& blends)
{
    Eigen::MatrixXd all = -blends.morphs;
    for (std::size_t i = 0; i < blends.weights.size(); ++i) all.col(Eigen::Index(i)) += function(blends.weights[i]);
    return all;
}

// Root mean squares of the vertices' distances; `gram` is deltas^T deltas over the number of vertices.
Eigen::VectorXd distances(const Eigen::MatrixXd& gram, const Eigen::MatrixXd& difference)
{
    return (gram * difference).cwiseProduct(difference).colwise().sum().cwiseMax(0).cwiseSqrt().transpose();
}

void add_worst(const Blends& blends, const Eigen::VectorXd& errors, std::vector<std::size_t>& centres)
{
    std::vector<std::size_t> order(blends.weights.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return errors[Eigen::Index(a)] > errors[Eigen::Index(b)]; });
    const std::size_t before = centres.size(), most = std::min(most_centres, before + centres_a_round);
    for (std::size_t i = 0; i < order.size() && centres.size() < most; ++i) {
        const auto is_far = [&](std::size_t k) {
            const double distance = (blends.weights[centres[k]] - blends.weights[order[i]]).norm();
            return distance > (k < before ? closest_centres : nearest_in_round);
        };
        bool is_new = true;
        for (std::size_t k = 0; k < centres.size() && is_new; ++k) is_new = is_far(k);
        if (is_new) centres.push_back(order[i]);
    }
}

void judge(PoseTable& table, const MorphMesh& mesh, const Blends& fresh)
{
    const Eigen::MatrixXd difference = differences(table.function, fresh);
    double sum = 0;
    for_each_batch(mesh.base.size(), difference.cols(), [&](Eigen::Index first, Eigen::Index count) {
        const Eigen::MatrixXd moved = (mesh.deltas * difference.middleCols(first, count).cast<float>()).cast<double>();
        const Eigen::RowVectorXd lengths
            = Eigen::Map<const Eigen::Matrix3Xd>(moved.data(), 3, moved.size() / 3).colwise().norm();
        sum += lengths.mean() * double(count);
        table.largest_error = std::max(table.largest_error, lengths.maxCoeff());
    });
    table.mean_error = sum / double(difference.cols()) / mesh.reachable.diagonal();
    table.largest_error /= mesh.reachable.diagonal();
}

} // namespace

PoseTable fit_pose_table(RuntimeBlender& blender, const MorphMesh& mesh)
{
    const Blends candidates = blends_at(blender, mesh, tried_count, tried_seed);
    const Eigen::MatrixXf square = mesh.deltas.transpose() * mesh.deltas;
    const Eigen::MatrixXd gram = square.cast<double>() / (double(mesh.deltas.rows()) / 3);
    std::vector<std::size_t> centres(std::size_t(blender.asset().weight_count) + 1); // poses or layers, and the centre
    std::iota(centres.begin(), centres.end(), std::size_t(0));
    PoseTable table;
    for (std::size_t before = 0; centres.size() != before;) {
        table.function = fit(candidates, centres);
        const Eigen::VectorXd errors = distances(gram, differences(table.function, candidates));
        before = centres.size();
        if (errors.mean() > wanted_mean * mesh.reachable.diagonal()) add_worst(candidates, errors, centres);
    }
    judge(table, mesh, blends_at(blender, mesh, fresh_count, fresh_seed));
    return table;
}

} // namespace pliant
