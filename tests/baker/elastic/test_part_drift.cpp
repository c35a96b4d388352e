// Which drift of parts a bake takes for the fault of its reduction.
#include "../parts_mesh.h"

#include "base/mesh/align.h"
#include "elastic/parts/drift.h"
#include "elastic/parts/find_ties.h"

#include <algorithm>
#include <doctest/doctest.h>

using namespace pliant;

namespace {

constexpr Eigen::Index eye_count = 48, jacket_count = 108;

struct Fixture {
    Fixture()
    {
        PartsMesh mesh;
        mesh.eye_turn = 1.2;
        mesh.has_vertex = false;
        set = normalize(mesh.poses(2));
        ties = find_ties(set);
        eye_limit = 1 / over_limit(moved(1, 0));
        jacket_limit = 1 / over_limit(moved(0, 1));
    }

    // The first pose, whose weight is 1: there every distance is drift.
    Shape moved(double eye, double jacket) const
    {
        Shape out = set.shapes[0];
        const Eigen::Index first = out.size() / 3 - eye_count - jacket_count;
        for (Eigen::Index i = 0; i < eye_count + jacket_count; ++i) out[3 * (first + i) + 1] += i < eye_count ? eye : jacket;
        return out;
    }

    double over_limit(const Shape& y) const
    {
        return std::max(measure_drift(ties, set, weights, y).largest / drift_limit,
                        measure_turn_drift(ties, weights, y).largest / turn_drift_limit);
    }

    double avoidable(const Shape& average, const Shape& blend) const
    {
        return avoidable_drift(ties, set, weights, average, blend);
    }

    NormalizedPoses set;
    TieSet ties;
    const Eigen::VectorXd weights = corner_weights(2, 0);
    double eye_limit = 0, jacket_limit = 0;
};

} // namespace

TEST_CASE_FIXTURE(Fixture, "drift is counted over the limit of its part, and the worst part counts")
{
    CHECK(eye_limit < 0.8 * jacket_limit); // the eye turns: its radius counts
    const Shape rest = moved(0, 0);
    CHECK(avoidable(rest, rest) < 1e-6);
    CHECK(avoidable(rest, moved(2 * eye_limit, 0)) == doctest::Approx(2));
    CHECK(avoidable(rest, moved(2 * eye_limit, 3 * jacket_limit)) == doctest::Approx(3));
    CHECK(avoidable(rest, moved(9 * eye_limit, 3 * jacket_limit)) == doctest::Approx(9));
}

TEST_CASE_FIXTURE(Fixture,
                  "a part does not count where its average drifts as far, or by so much that its place says nothing")
{
    const Shape average = moved(2 * eye_limit, 0), adrift = moved(6 * eye_limit, 0);
    CHECK(avoidable(average, average) == 0);
    CHECK(avoidable(average, moved(2.1 * eye_limit, 0)) == 0);
    CHECK(avoidable(average, moved(3 * eye_limit, 0)) == doctest::Approx(3));
    CHECK(avoidable(adrift, moved(12 * eye_limit, 0)) == 0);
    CHECK(avoidable(adrift, moved(12 * eye_limit, 3 * jacket_limit)) == doctest::Approx(3));
}
