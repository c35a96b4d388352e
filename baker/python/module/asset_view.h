// An asset as Python holds it: the C runtime on the bytes of a Python object.
#pragma once

#include "arrays.h"
#include "surrogate.h"

#include "pliant.h"

#include <memory>
#include <vector>

namespace pliant {

// Keeps the object that owns the bytes. `bytes` and read-only `mmap` objects are used in place; what could change under the
// runtime, or does not lie at a multiple of 16, is copied. Calls may come from several threads: every call has a solver to
// itself.
class AssetView {
public:
    // Throws Failure (bad_input, P5102) naming `name` if the runtime refuses the bytes. verify: compare the checksums, too.
    AssetView(const nb::object& bytes, const std::string& name, bool verify);
    ~AssetView();
    AssetView(const AssetView&) = delete;
    AssetView& operator=(const AssetView&) = delete;

    const pliant_asset& asset() const { return asset_; }
    bool is_in_place() const { return copy_.empty(); }
    nb::bytes bytes() const; // the object itself if it is one

    // (k, weight_count) weights to (k, d) coordinates. Rows are independent of each other, or with `continuous` go on from
    // the one before. Throws Failure (usage, P1204) for weights that are none.
    nb::object solve(const Array<float, 2>& weights, bool continuous);

    // Rows of weights and of coordinates (k, d) to the values (k) of the function that the solver minimises for the weights,
    // and its gradients by q (k, d). A value that is not finite comes back as +infinity, its gradient as not a number.
    nb::object energy(const Array<float, 2>& weights, const Array<double, 2>& q);

    // (k, d) coordinates to (k, count, 3) positions; vertices are numbered as the input was. first + count is at most the
    // vertex count.
    nb::object reconstruct(const Array<float, 2>& q, std::size_t first, std::size_t count) const;

    // (k, n, 3) positions to as many normals; vertices inside a solid have (0, 0, 1).
    nb::object normals(const Array<float, 3>& positions);

    // Faces and triangles by the numbers of the input.
    nb::object faces() const;
    nb::object triangles() const;
    nb::object pose_coordinates() const; // (m, d)
    nb::list names() const;              // as bytes, since an asset may hold any
    nb::list weights() const;            // of each weight name, low, high, initial

private:
    struct Solver;
    class Loan;

    std::uint32_t input_number(std::uint32_t vertex) const
    {
        return asset_.source_vertices ? asset_.source_vertices[vertex] : vertex;
    }
    void reconstruct_one(const float* q, std::size_t first, std::size_t count, float* out, std::vector<float>& buffer) const;
    void normals_of_one(const float* positions, float* out, std::vector<float>& buffer) const;
    void prepare_normals();
    const SurrogateCoordinates& surrogate_coordinates();
    [[noreturn]] void refuse_weights(pliant_result result, const Array<float, 2>& weights, std::size_t row) const;

    Py_buffer buffer_ {};
    std::vector<std::uint64_t> copy_; // empty: in place
    pliant_asset asset_ {};
    // What follows changes only while the interpreter is locked: a lock that forked children have, too.
    std::vector<std::unique_ptr<Solver>> idle_;
    std::unique_ptr<SurrogateCoordinates> surrogate_coordinates_;
    std::vector<std::uint64_t> normals_memory_;
    pliant_normals normals_ {};
};

} // namespace pliant
