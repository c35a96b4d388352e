// Functions of the weights.
#include "base/weights/domain.h"
#include "base/weights/hermite_interpolation.h"
#include "base/weights/sampling.h"

#include <doctest/doctest.h>
#include <functional>
#include <set>
#include <string>

using namespace pliant;

namespace {

using Function = std::function<double(const Weights&)>;

// The corners, and the first training weights.
std::vector<Weights> centres_of(std::size_t pose_count, std::size_t count)
{
    std::vector<Weights> centres = training_weights(pose_count, count, 1);
    for (std::size_t k = 0; k < pose_count; ++k) centres.push_back(corner_weights(pose_count, k));
    return centres;
}

// Its value at w, interpolated from values and derivatives (by differences) at the centres.
double interpolate(const std::vector<Weights>& centres, const Function& f, const Weights& w)
{
    const Eigen::MatrixXd directions = weight_directions(std::size_t(w.size()));
    const Eigen::MatrixXd shares = HermiteInterpolation(centres).shares(w);
    constexpr double step = 1e-5;
    double sum = 0;
    for (std::size_t i = 0; i < centres.size(); ++i) {
        sum += shares(0, Eigen::Index(i)) * f(centres[i]);
        for (Eigen::Index c = 0; c < directions.cols(); ++c) {
            const Weights ahead = centres[i] + step * directions.col(c), behind = centres[i] - step * directions.col(c);
            sum += shares(1 + c, Eigen::Index(i)) * (f(ahead) - f(behind)) / (2 * step);
        }
    }
    return sum;
}

} // namespace

TEST_CASE("directions of weights are orthonormal and keep the sum")
{
    for (std::size_t m : { 2, 3, 12 }) {
        const Eigen::MatrixXd directions = weight_directions(m);
        CHECK((directions.transpose() * directions - Eigen::MatrixXd::Identity(directions.cols(), directions.cols())).norm()
              < 1e-12);
        CHECK(directions.colwise().sum().norm() < 1e-12);
    }
}

TEST_CASE("interpolation from values and derivatives: quadratic functions exactly, smooth ones better with more centres")
{
    const Function quadratic = [](const Weights& w) { return 1 + w[0] * w[1] + 0.3 * w[0] * w[0]; };
    const Function smooth = [](const Weights& w) { return std::exp(2 * w[0]) * w[1] + std::sin(3 * w[1]); };
    for (std::size_t m : { 2, 3, 5 }) {
        CAPTURE(m);
        double few = 0, many = 0;
        for (const Weights& w : draw_weights(3, m, 6)) {
            CHECK(interpolate(centres_of(m, 3), quadratic, w) == doctest::Approx(quadratic(w)).epsilon(1e-8));
            few = std::max(few, std::abs(interpolate(centres_of(m, 3), smooth, w) - smooth(w)));
            many = std::max(many, std::abs(interpolate(centres_of(m, 24), smooth, w) - smooth(w)));
        }
        CHECK(many < 0.3 * few);
        const Weights known = training_weights(m, 3, 1)[2];
        CHECK(interpolate(centres_of(m, 3), smooth, known) == doctest::Approx(smooth(known)).epsilon(1e-9));
    }
}

TEST_CASE("mixtures of layers lie in the box, and their kinds are what they are called")
{
    std::vector<WeightRange> ranges(9);
    ranges[2] = { -0.5, 1.5, 0 };
    const WeightDomain domain = WeightDomain::box(ranges);
    std::set<std::string> kinds;
    for (const Weights& v : domain.draw_all(4, 60)) {
        const std::string kind = domain.kind_of(v, 0);
        kinds.insert(kind);
        const long used = (v.array() != 0).count();
        CHECK(domain.is_counted(v) == (used <= 6));
        if (kind == "single") CHECK(used <= 1);
        if (kind == "pair") CHECK(used == 2);
        if (kind == "sparse") CHECK((used > 2 && used <= 6));
        if (kind == "dense") CHECK(used > 6);
        for (std::size_t k = 0; k < ranges.size(); ++k) {
            CHECK(v[Eigen::Index(k)] >= ranges[k].low);
            CHECK(v[Eigen::Index(k)] <= ranges[k].high);
        }
    }
    CHECK(kinds == std::set<std::string> { "single", "pair", "sparse", "dense", "corner" });
    for (const Weights& v : domain.draw_counted(4, 20)) CHECK(domain.is_counted(v));
    CHECK(domain.covering(5, 1).size() == 15);
    CHECK(domain.covering(5, 1)[2][2] == 1.5f);
    CHECK(WeightDomain::simplex(3).centre() == equal_weights(3));
}
