#include "base/mesh/fans.h"

#include <algorithm>
#include <tuple>

namespace pliant {

namespace {

// A face as its corner sees it: (corner, from, to) counter-clockwise.
struct Wedge {
    std::uint32_t from, to;
};

// A face that has the neighbour, by its number among the wedges of the centre.
struct Spoke {
    std::uint32_t neighbour;
    std::size_t wedge;
};

// All faces around one vertex.
class Star {
public:
    explicit Star(const std::vector<Wedge>& wedges)
        : wedges_(wedges)
        , is_visited_(wedges.size(), false)
    {
        for (std::size_t i = 0; i < wedges.size(); ++i) {
            spokes_.push_back({ wedges[i].from, i });
            spokes_.push_back({ wedges[i].to, i });
        }
        std::sort(spokes_.begin(), spokes_.end(), [](const Spoke& a, const Spoke& b) {
            return std::tie(a.neighbour, a.wedge) < std::tie(b.neighbour, b.wedge);
        });
    }

    // Chains from their first faces, then from faces that another orientation makes the first, then closed rings.
    void add_fans(std::uint32_t centre, std::vector<Fan>& fans)
    {
        for (const Spoke& spoke : spokes_)
            if (!crossed(spoke) && wedges_[spoke.wedge].from == spoke.neighbour) add_fan(centre, spoke, fans);
        for (const Spoke& spoke : spokes_)
            if (!crossed(spoke)) add_fan(centre, spoke, fans);
        for (const Spoke& spoke : spokes_)
            if (wedges_[spoke.wedge].from == spoke.neighbour) add_fan(centre, spoke, fans);
    }

private:
    // The face on the other side of an edge of exactly two faces; null at any other edge.
    const Spoke* crossed(const Spoke& spoke) const
    {
        const auto [first, last] = std::equal_range(
            spokes_.begin(), spokes_.end(), spoke, [](const Spoke& a, const Spoke& b) { return a.neighbour < b.neighbour; });
        if (last - first != 2) return nullptr;
        return first->wedge == spoke.wedge ? &*(first + 1) : &*first;
    }

    void add_fan(std::uint32_t centre, const Spoke& start, std::vector<Fan>& fans)
    {
        if (is_visited_[start.wedge]) return;
        Fan fan { centre, { start.neighbour }, false };
        for (Spoke at = start;;) {
            is_visited_[at.wedge] = true;
            const Wedge& wedge = wedges_[at.wedge];
            at.neighbour = wedge.from == at.neighbour ? wedge.to : wedge.from;
            fan.is_closed = at.neighbour == start.neighbour;
            if (fan.is_closed) break;
            fan.ring.push_back(at.neighbour);
            const Spoke* next = crossed(at);
            if (!next) break;
            at = *next;
        }
        fans.push_back(std::move(fan));
    }

    const std::vector<Wedge>& wedges_;
    std::vector<Spoke> spokes_;
    std::vector<bool> is_visited_;
};

void add_in_pieces(const Fan& fan, std::vector<Fan>& fans)
{
    if (fan.ring.size() <= ring_limit) {
        fans.push_back(fan);
        return;
    }
    // A closed ring begins and ends with its first face.
    const std::size_t count = fan.ring.size(), end = fan.is_closed ? count + 2 : count;
    for (std::size_t begin = 0; begin + 2 < end; begin += ring_limit - 2) {
        Fan piece { fan.centre, {}, false };
        for (std::size_t i = begin; i < std::min(end, begin + ring_limit); ++i) piece.ring.push_back(fan.ring[i % count]);
        fans.push_back(std::move(piece));
    }
}

} // namespace

std::vector<Fan> find_fans(const std::vector<Triangle>& triangles, const Shape& rest)
{
    std::vector<std::vector<Wedge>> wedges(std::size_t(rest.size() / 3));
    for (const Triangle& t : triangles)
        for (int c = 0; c < 3; ++c) wedges[t[c]].push_back({ t[(c + 1) % 3], t[(c + 2) % 3] });
    std::vector<Fan> whole;
    for (std::uint32_t v = 0; v < wedges.size(); ++v) Star(wedges[v]).add_fans(v, whole);
    for (const Hinge& hinge : find_crowded_hinges(triangles, rest)) {
        const auto& [first, second, left, right] = hinge.vertices;
        whole.push_back({ first, { left, second, right }, false });
        whole.push_back({ second, { left, first, right }, false });
    }
    std::stable_sort(whole.begin(), whole.end(), [](const Fan& a, const Fan& b) { return a.centre < b.centre; });
    std::vector<Fan> fans;
    for (const Fan& fan : whole) add_in_pieces(fan, fans);
    return fans;
}

} // namespace pliant
