// Arrays of numpy in and out.
#pragma once

#include "base/mesh/pose_set.h"

#include <cstdint>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <optional>
#include <string>
#include <vector>

namespace pliant {

namespace nb = nanobind;

template <class T, int dimensions> using Array = nb::ndarray<const T, nb::ndim<dimensions>, nb::c_contig, nb::device::cpu>;

// Poses as they were given or read, before any check of one against another.
struct SourcePoses {
    std::vector<MeshFile> meshes;
    Blend blend = Blend::average; // what the source means
    bool share_frame = false;     // of one glTF file
};

// positions (m, n, 3) with names for each pose; the cells are faces (f, k) with k >= 3, or tets (t, 4). What messages call
// the poses:
// `label`[0], `label`[1], ... Throws Failure (bad_input, P2103, P2105, P2108, P2113, ...) as the readers of files do.
SourcePoses poses_of_arrays(const Array<double, 3>& positions, const std::optional<Array<std::int64_t, 2>>& faces,
                            const std::optional<Array<std::int64_t, 2>>& tets, const std::vector<std::string>& names,
                            const std::string& label);

// An array that owns its numbers. `values` has as many as the shape says.
template <class T> nb::object to_numpy(std::vector<T> values, std::initializer_list<std::size_t> shape)
{
    if (values.capacity() == 0) values.reserve(1); // an array without numbers has an address, too
    auto* kept = new std::vector<T>(std::move(values));
    nb::capsule owner(kept, [](void* memory) noexcept { delete static_cast<std::vector<T>*>(memory); });
    return nb::cast(nb::ndarray<nb::numpy, T>(kept->data(), shape, owner));
}

// (f, k) if all faces have k corners, else their triangles (t, 3), each face a fan from its first corner. Indices are
// uint32.
nb::object faces_to_numpy(const Polygons& faces);

} // namespace pliant
