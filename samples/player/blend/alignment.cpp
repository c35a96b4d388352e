#include "blend/alignment.h"

#include <glm/gtc/quaternion.hpp>

#include <array>
#include <cmath>

namespace pliant::player {
namespace {

using Matrix4 = std::array<std::array<double, 4>, 4>;

// One Jacobi rotation in the plane of axes p and q, after which a[p][q] is zero; `vectors` accumulates the rotations.
void turn_plane(Matrix4& a, Matrix4& vectors, int p, int q)
{
    if (a[p][q] == 0.0) return;
    const double theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
    const double t = (theta >= 0.0 ? 1.0 : -1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
    const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
    for (int k = 0; k < 4; ++k) {
        const double kp = a[k][p], kq = a[k][q];
        a[k][p] = c * kp - s * kq;
        a[k][q] = s * kp + c * kq;
    }
    for (int k = 0; k < 4; ++k) {
        const double pk = a[p][k], qk = a[q][k];
        a[p][k] = c * pk - s * qk;
        a[q][k] = s * pk + c * qk;
        const double vp = vectors[k][p], vq = vectors[k][q];
        vectors[k][p] = c * vp - s * vq;
        vectors[k][q] = s * vp + c * vq;
    }
}

// The eigenvector of the largest eigenvalue, by cyclic Jacobi sweeps.
std::array<double, 4> top_eigenvector(Matrix4 a)
{
    constexpr int sweep_count = 12; // converges quadratically: six reach double precision, also with equal eigenvalues
    Matrix4 vectors {};
    for (int i = 0; i < 4; ++i) vectors[i][i] = 1.0;
    for (int sweep = 0; sweep < sweep_count; ++sweep) {
        for (int p = 0; p < 4; ++p)
            for (int q = p + 1; q < 4; ++q) turn_plane(a, vectors, p, q);
    }
    int top = 0;
    for (int i = 1; i < 4; ++i)
        if (a[i][i] > a[top][top]) top = i;
    return { vectors[0][top], vectors[1][top], vectors[2][top], vectors[3][top] };
}

} // namespace

RigidMotion best_motion(const std::vector<glm::vec3>& from, const std::vector<glm::vec3>& onto, std::size_t count)
{
    RigidMotion motion;
    if (count == 0) return motion;
    for (std::size_t v = 0; v < count; ++v) {
        motion.centre += glm::dvec3(from[v]);
        motion.target += glm::dvec3(onto[v]);
    }
    motion.centre /= static_cast<double>(count);
    motion.target /= static_cast<double>(count);
    double s[3][3] = {};
    for (std::size_t v = 0; v < count; ++v) {
        const glm::dvec3 a = glm::dvec3(from[v]) - motion.centre, b = glm::dvec3(onto[v]) - motion.target;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) s[i][j] += a[i] * b[j];
    }
    // Horn's matrix: its top eigenvector is the rotation as a quaternion (w, x, y, z).
    const Matrix4 n { { { s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0] },
                        { s[1][2] - s[2][1], s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2] },
                        { s[2][0] - s[0][2], s[0][1] + s[1][0], s[1][1] - s[0][0] - s[2][2], s[1][2] + s[2][1] },
                        { s[0][1] - s[1][0], s[2][0] + s[0][2], s[1][2] + s[2][1], s[2][2] - s[0][0] - s[1][1] } } };
    const std::array<double, 4> q = top_eigenvector(n);
    motion.rotation = glm::mat3_cast(glm::dquat(q[0], q[1], q[2], q[3]));
    return motion;
}

} // namespace pliant::player
