/* What engines do with the same vertices: a linear sum of morph targets, linear blend skinning, dual quaternions. */
#ifndef PLIANT_BENCH_ENGINE_MESH_H
#define PLIANT_BENCH_ENGINE_MESH_H

#include <stddef.h>
#include <stdint.h>

enum { bone_count = 64, influence_count = 4 };

/* Bytes that a vertex reads. */
enum { skin_bytes = 12 + influence_count * 5 };

typedef struct engine_mesh {
    size_t vertex_count;
    uint32_t pose_count;
    float* targets;   /* pose_count times 3n: the first pose, then differences from it */
    uint8_t* bones;   /* influence_count a vertex */
    float* influence; /* as many, sum 1 */
} engine_mesh;

/* Where the bones are: 64 bytes a matrix (four columns of x y z and a zero), 32 bytes a dual quaternion (x y z w of the real
   part, then of the dual part). All real parts lie in one hemisphere, so that no sign needs to be looked at. */
typedef struct bone_pose {
    float matrices[bone_count][16];
    float duals[bone_count][8];
} bone_pose;

/* Owns what it allocates, to the end of the program. `poses`: pose_count times 3n. Bones sit at evenly numbered vertices, a
   vertex hangs on the four nearest ones. */
engine_mesh make_engine_mesh(size_t vertex_count, uint32_t pose_count, const float* poses);

/* Bones that turn by some tenths. */
void pose_bones(int frame, bone_pose* pose);

/* Positions, x y z each. */
void blend_linearly(const engine_mesh* mesh, const float* weights, float* out);
void blend_matrices(const engine_mesh* mesh, const bone_pose* pose, float* out);
void blend_dual_quaternions(const engine_mesh* mesh, const bone_pose* pose, float* out);

#endif
