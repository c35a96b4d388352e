/** @file
   Pliant for C++17: the runtime with owners, exceptions and ranges. Header only, on top of pliant.h, which is the manual.

   @code
   const pliant::Asset asset(bytes);                    // once per asset
   pliant::Solver solver(asset);                        // once per character
   std::vector<float> positions(3 * asset->vertex_count);
   solver.solve({ 0.25f, 0.75f });                      // once per frame
   pliant::reconstruct(asset, solver.coordinates(), positions);
   @endcode

   Wrong arguments and bad assets throw pliant::Error. Nothing else throws but std::bad_alloc, and only constructors
   allocate. An object that was moved from may be assigned to or destroyed, nothing else. Threads: as pliant.h says of the
   C objects inside. */
#ifndef PLIANT_HPP
#define PLIANT_HPP

#include "pliant.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace pliant {

/** A result other than PLIANT_OK; what() is pliant_result_text(). */
class Error : public std::runtime_error {
public:
    explicit Error(pliant_result result)
        : std::runtime_error(pliant_result_text(result))
        , result_(result)
    {
    }
    pliant_result result() const noexcept { return result_; }

private:
    pliant_result result_;
};

/** Throws Error unless `result` is PLIANT_OK. */
inline void require(pliant_result result)
{
    if (result != PLIANT_OK) throw Error(result);
}

/** `size` elements at `data` that somebody else owns, as std::span of C++20. Made of anything with data() and size(). */
template <class T> class Span {
public:
    constexpr Span() = default;
    constexpr Span(T* data, std::size_t size)
        : data_(data)
        , size_(size)
    {
    }
    template <class Container,
              class = std::enable_if_t<std::is_convertible_v<decltype(std::declval<Container&>().data()), T*>>>
    constexpr Span(Container&& container)
        : data_(container.data())
        , size_(container.size())
    {
    }

    constexpr T* data() const { return data_; }
    constexpr std::size_t size() const { return size_; }
    constexpr bool empty() const { return size_ == 0; }
    constexpr T& operator[](std::size_t i) const { return data_[i]; }
    constexpr T* begin() const { return data_; }
    constexpr T* end() const { return data_ + size_; }

private:
    T* data_ = nullptr;
    std::size_t size_ = 0;
};

/** An opened asset. Solvers, normals and spans point into it: it must outlive them. Moving keeps them valid. */
class Asset {
public:
    /** Copies the bytes of a .pliant file, at any address, and opens them. */
    explicit Asset(Span<const unsigned char> bytes, std::uint32_t flags = PLIANT_OPEN_VERIFY_CHECKSUMS)
        : block_(std::make_unique<unsigned char[]>(bytes.size() + alignment))
    {
        const std::size_t skip = alignment - reinterpret_cast<std::uintptr_t>(block_.get()) % alignment;
        if (!bytes.empty()) std::memcpy(block_.get() + skip, bytes.data(), bytes.size());
        require(pliant_asset_open(&view_, block_.get() + skip, bytes.size(), flags));
    }

    /** Opens bytes where they are, at a multiple of 16; they must outlive the asset. For mapped files and archives. */
    static Asset in_place(Span<const unsigned char> bytes, std::uint32_t flags = PLIANT_OPEN_DEFAULT)
    {
        Asset asset;
        require(pliant_asset_open(&asset.view_, bytes.data(), bytes.size(), flags));
        return asset;
    }

    Asset(Asset&&) noexcept = default;
    Asset& operator=(Asset&&) noexcept = default;

    const pliant_asset* get() const { return &view_; }
    const pliant_asset* operator->() const { return &view_; } /**< asset->vertex_count and the other fields of pliant.h */

    /** Name, range and first value of a weight. Throws Error if there is no such weight. */
    pliant_weight weight(std::uint32_t index) const
    {
        pliant_weight weight {};
        require(pliant_asset_weight(&view_, index, &weight));
        return weight;
    }

    /** The number of the weight with this name, or weight_count if there is none. */
    std::uint32_t find_weight(std::string_view name) const
    {
        std::uint32_t index = 0;
        while (index < view_.weight_count && name != weight(index).name) ++index;
        return index;
    }

    /** The indices of all triangles, three each. */
    Span<const std::uint32_t> triangles() const { return { view_.triangles, 3 * std::size_t(view_.triangle_count) }; }

    /** The coordinates that reproduce a pose. Throws Error if there is no such pose. */
    Span<const float> pose_coordinates(std::uint32_t pose) const
    {
        const float* q = pliant_asset_pose_coordinates(&view_, pose);
        if (!q) throw Error(PLIANT_ERROR_ARGUMENT);
        return { q, view_.dimension };
    }

private:
    Asset() = default;
    static constexpr std::size_t alignment = 16;

    std::unique_ptr<unsigned char[]> block_;
    pliant_asset view_ {};
};

/** One character. */
class Solver {
public:
    explicit Solver(const Asset& asset, const pliant_solver_desc& desc = pliant_solver_desc_default())
        : weight_count_(asset->weight_count)
        , coordinates_(asset->dimension)
    {
        const std::size_t size = pliant_solver_memory(asset.get(), &desc);
        memory_ = std::make_unique<unsigned char[]>(size);
        require(pliant_solver_init(&solver_, asset.get(), &desc, memory_.get(), size));
    }

    /** Blends. Throws Error for weights of another number than the asset's, or that it does not take; coordinates() are then
       those of before. */
    pliant_solve_info solve(Span<const float> weights)
    {
        pliant_solve_info info;
        if (weights.size() != weight_count_) throw Error(PLIANT_ERROR_ARGUMENT);
        require(pliant_solve(solver_, weights.data(), coordinates_.data(), &info));
        return info;
    }

    pliant_solve_info solve(std::initializer_list<float> weights)
    {
        return solve(Span<const float>(weights.begin(), weights.size()));
    }

    /** Of the last blend (dimension floats; all 0 before the first). */
    Span<const float> coordinates() const { return coordinates_; }

    /** For cuts and teleports: the next frame starts anew. */
    void reset() { pliant_solver_reset(solver_); }

private:
    std::size_t weight_count_;
    std::vector<float> coordinates_;
    std::unique_ptr<unsigned char[]> memory_;
    pliant_solver* solver_ = nullptr;
};

/** Positions of all vertices (3 vertex_count floats). Throws Error for spans of other sizes. For ranges and strides:
   pliant_reconstruct. */
inline void reconstruct(const Asset& asset, Span<const float> coordinates, Span<float> positions)
{
    if (coordinates.size() != asset->dimension || positions.size() != 3 * std::size_t(asset->vertex_count))
        throw Error(PLIANT_ERROR_ARGUMENT);
    pliant_reconstruct(asset.get(), coordinates.data(), 0, asset->vertex_count, positions.data(), 3 * sizeof(float));
}

/** Makes normals of positions. */
class Normals {
public:
    explicit Normals(const Asset& asset)
        : vertex_count_(asset->vertex_count)
    {
        const std::size_t size = pliant_normals_memory(asset.get());
        memory_ = std::make_unique<unsigned char[]>(size);
        require(pliant_normals_init(&normals_, asset.get(), memory_.get(), size));
    }

    /** Normals of the first boundary_vertex_count vertices from the positions of all. Throws Error for spans of other sizes.
       For ranges and strides: pliant_normals_compute with get(). */
    void compute(Span<const float> positions, Span<float> normals) const
    {
        const std::size_t count = normals_.vertex_count;
        if (positions.size() != 3 * vertex_count_ || normals.size() != 3 * count) throw Error(PLIANT_ERROR_ARGUMENT);
        pliant_normals_compute(&normals_, positions.data(), 3 * sizeof(float), 0, normals_.vertex_count, normals.data(),
                               3 * sizeof(float));
    }

    const pliant_normals* get() const { return &normals_; }

private:
    std::size_t vertex_count_;
    std::unique_ptr<unsigned char[]> memory_;
    pliant_normals normals_ {};
};

} // namespace pliant

#endif
