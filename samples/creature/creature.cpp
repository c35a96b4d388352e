#include "creature.h"

#include "anatomy.h"
#include "polygonise.h"
#include "remesh.h"
#include "rig.h"

namespace pliant::creature {

Character build_character(int vertex_count)
{
    const Anatomy anatomy = build_anatomy();
    // Fine enough to separate toes and gills; the remesher sets the final density.
    const double cell = 0.06;
    const Mesh rough = polygonise(anatomy.skin, anatomy.box_min, anatomy.box_max, cell);
    const Mesh bind = remesh(rough, anatomy.skin, anatomy.sizing, vertex_count, 12);
    const Eigen::MatrixXd weights = skin_weights(bind, anatomy);
    Character character;
    character.faces = bind.faces;
    for (const Pose& pose : character_poses())
        character.poses.push_back({ pose.name, pose_points(bind, anatomy, weights, pose) });
    return character;
}

} // namespace pliant::creature
