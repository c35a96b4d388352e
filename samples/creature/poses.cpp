#include "poses.h"

namespace pliant::creature {
namespace {

// The natural curve of the gills, symmetric; `flare` raises them.
void add_gills(std::vector<Bend>& bends, double flare)
{
    for (const char* side : { ".left", ".right" }) {
        bends.push_back({ std::string("gill.top") + side, 0.3, 1.1, -15, 35 + flare, 0 });
        bends.push_back({ std::string("gill.middle") + side, 0.35, 1.25, -25, 35 + flare, 0 });
        bends.push_back({ std::string("gill.bottom") + side, 0.3, 1.1, -20, -20 + flare, 0 });
    }
}

Pose pose(const std::string& name, double pitch, double roll, double yaw, double flare, std::vector<Bend> bends)
{
    add_gills(bends, flare);
    return { name, pitch, roll, yaw, std::move(bends) };
}

} // namespace

std::vector<Pose> character_poses()
{
    return {
        pose("rest", 0, 0, 0, 0,
             { { "spine", -1.6, -3.6, 30, 0, 0 },
               { "spine", -3.4, -6.2, -95, 15, 0 },
               { "spine", 1.0, 2.5, 0, 45, 0 },
               { "spine", 2.1, 3.2, 0, -45, 0 },
               { "arm.left", 0.75, 1.6, 30, -55, 0 },
               { "arm.left", 1.6, 2.3, 0, 50, 0 },
               { "arm.right", 0.75, 1.6, 30, -55, 0 },
               { "arm.right", 1.6, 2.3, 0, 50, 0 },
               { "leg.left", 0.8, 1.65, 30, -55, 0 },
               { "leg.left", 1.65, 2.3, 0, 50, 0 },
               { "leg.right", 0.8, 1.65, 30, -55, 0 },
               { "leg.right", 1.65, 2.3, 0, 50, 0 } }),
        pose("reach", 62, 0, 0, 25,
             { { "spine", -1.4, -3.4, 0, 62, 0 },
               { "spine", -3.2, -6.2, 80, 20, 0 },
               { "spine", 1.1, 3.2, 15, -55, 0 },
               { "arm.left", 0.7, 1.7, 48, -15, 0 },
               { "arm.left", 1.6, 2.3, 10, 25, 0 },
               { "arm.right", 0.7, 1.6, -15, -60, 0 },
               { "arm.right", 1.4, 2.3, 95, 0, 0 },
               { "leg.left", 0.8, 1.8, -10, -85, 0 },
               { "leg.left", 1.6, 2.3, 55, 0, 0 },
               { "leg.right", 0.8, 1.8, -10, -85, 0 },
               { "leg.right", 1.6, 2.3, 55, 0, 0 } }),
        pose("curl", 0, 0, 0, 0,
             { { "spine", -1.3, -4.0, 75, 0, 0 },
               { "spine", -2.6, -6.3, 150, 10, 0 },
               { "spine", -4.2, -6.3, 120, 0, 0 },
               { "spine", -0.9, 0.7, 25, 0, 0 },
               { "spine", 1.1, 3.1, 78, 22, 0 },
               { "arm.left", 0.75, 1.7, 20, -75, 0 },
               { "arm.left", 1.6, 2.3, 0, 60, 0 },
               { "arm.right", 0.75, 2.1, 115, -20, 0 },
               { "leg.left", 0.8, 1.75, -25, -75, 0 },
               { "leg.left", 1.65, 2.3, 0, 60, 0 },
               { "leg.right", 0.8, 2.2, 100, -25, 0 } }),
        pose("leap", 25, 0, 0, 10,
             { { "spine", -1.5, -3.5, 0, 45, 0 },
               { "spine", -3.2, -6.2, 0, -95, 0 },
               { "spine", -0.8, 0.8, 0, 20, 0 },
               { "spine", 1.1, 3.0, 0, -15, 0 },
               { "arm.left", 0.75, 1.8, 60, -40, 0 },
               { "arm.right", 0.75, 1.8, 65, -40, 0 },
               { "leg.left", 0.8, 2.1, -85, 10, 0 },
               { "leg.right", 0.8, 2.1, -80, -20, 0 } }),
        pose("twist", 0, 43, 0, 15,
             { { "spine", -1.7, -6.0, 0, 0, 250 },
               { "spine", -1.5, -3.6, 24, 26, 0 },
               { "spine", -3.2, -6.2, -44, 41, 0 },
               { "spine", -1.0, 0.75, 0, 0, 75 },
               { "spine", 1.1, 3.1, 55, -35, -60 },
               { "arm.left", 0.75, 1.6, 40, -10, 0 },
               { "arm.left", 1.5, 2.3, -50, 0, 0 },
               { "arm.right", 0.75, 1.7, 70, 0, 0 },
               { "arm.right", 1.6, 2.3, 30, 0, 0 },
               { "leg.left", 0.8, 1.65, 30, -55, 0 },
               { "leg.left", 1.65, 2.3, 0, 50, 0 },
               { "leg.right", 0.8, 1.65, 30, -55, 0 },
               { "leg.right", 1.65, 2.3, 0, 50, 0 } }),
    };
}

} // namespace pliant::creature
