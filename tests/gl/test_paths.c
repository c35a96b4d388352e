/* Every way to draw gives the shape of the processor: positions within 1e-4 of the diagonal, normals within 1 degree. Run
   once for each kind of context: test_paths CONTEXT ASSET... (CONTEXT: gl33, gl43, es30, es31). Textures are tried in their
   usual size and so small that everything takes several layers. */
#include "gl_test.h"

#include <math.h>

static const wished_context* wished;

/* The processor's answer. */
typedef struct expected_shape {
    float *positions, *normals;
    float diagonal;
} expected_shape;

static expected_shape expect_shape(const pliant_asset* asset, const pliant_normals* normals, const float* q)
{
    const uint32_t n = asset->boundary_vertex_count;
    expected_shape e = { malloc((size_t)n * 12), malloc((size_t)n * 12), 0.0f };
    if (!e.positions || !e.normals) exit(2);
    pliant_reconstruct(asset, q, 0, n, e.positions, 12);
    pliant_normals_compute(normals, e.positions, 12, 0, n, e.normals, 12);
    for (uint32_t c = 0; c < 3; ++c) {
        float low = e.positions[c], high = low;
        for (uint32_t v = 0; v < n; ++v) {
            low = fminf(low, e.positions[3 * v + c]);
            high = fmaxf(high, e.positions[3 * v + c]);
        }
        e.diagonal += (high - low) * (high - low);
    }
    e.diagonal = sqrtf(e.diagonal);
    return e;
}

static void free_shape(expected_shape e)
{
    free(e.positions);
    free(e.normals);
}

static double distance(const float* a, const float* b)
{
    double sum = 0.0;
    for (int c = 0; c < 3; ++c) sum += ((double)a[c] - (double)b[c]) * ((double)a[c] - (double)b[c]);
    return sqrt(sum);
}

static void compare_positions(const char* name, GLuint buffer, const expected_shape* e, uint32_t n)
{
    float* found = read_buffer(buffer, n);
    for (uint32_t v = 0; v < n; ++v) {
        const double error = distance(found + 3 * v, e->positions + 3 * v) / (double)e->diagonal;
        CHECK(error < 1e-4, "%s, %s: vertex %u of %u is off by %g of the diagonal", wished->name, name, v, n, error);
    }
    free(found);
}

/* A chord of 0.01745 is 1 degree. Where the sum of a vertex's triangles nearly vanishes rounding decides;
   no asset here has such. */
static void compare_normals(const char* name, GLuint buffer, const expected_shape* e, uint32_t n)
{
    float* found = read_buffer(buffer, n);
    for (uint32_t v = 0; v < n; ++v) {
        const double error = distance(found + 3 * v, e->normals + 3 * v);
        CHECK(error < 0.01745, "%s, %s: normal %u of %u is off by %g: %g %g %g", wished->name, name, v, n, error,
              (double)found[3 * v], (double)found[3 * v + 1], (double)found[3 * v + 2]);
    }
    free(found);
}

/* A point between and around the poses, and off them in every dimension: poses alone leave some at zero. */
static void choose_q(const pliant_asset* asset, uint64_t* state, float* q)
{
    float largest = 0.0f;
    memset(q, 0, asset->dimension * sizeof *q);
    for (uint32_t k = 0; k < asset->pose_count; ++k) {
        const float* pose = pliant_asset_pose_coordinates(asset, k);
        const float weight = random_unit(state);
        for (uint32_t j = 0; j < asset->dimension; ++j) {
            q[j] += weight * pose[j];
            largest = fmaxf(largest, fabsf(pose[j]));
        }
    }
    for (uint32_t j = 0; j < asset->dimension; ++j) q[j] += 0.2f * largest * (random_unit(state) - 0.5f);
}

/* ------------------------------------------------------------------------------------------------ into buffers ---- */

enum { INSTANCES = 3 };

static void check_instances(const opened* o, pliant_gl* gl, const char* name)
{
    made_normals adjacency = make_normals(&o->asset);
    pliant_gl_mesh mesh;
    pliant_gl_instance instances[INSTANCES];
    expected_shape expected[INSTANCES];
    uint64_t state = 71;
    const pliant_gl_result made = pliant_gl_mesh_init(&mesh, gl, &o->asset, &adjacency.normals);
    CHECK(made == PLIANT_GL_OK, "%s: %s", name, pliant_gl_result_text(made));
    if (made != PLIANT_GL_OK) return;
    for (int i = 0; i < INSTANCES; ++i) {
        float q[256];
        choose_q(&o->asset, &state, q);
        CHECK(pliant_gl_instance_init(&instances[i], &mesh) == PLIANT_GL_OK, "%s: instance %d", name, i);
        CHECK(pliant_gl_update(&instances[i], q) == PLIANT_GL_OK, "%s: update %d", name, i);
        expected[i] = expect_shape(&o->asset, &adjacency.normals, q);
    }
    free(adjacency.memory);
    for (int i = 0; i < INSTANCES; ++i) { /* after all updates: none wrote another's */
        compare_positions(name, instances[i].position_buffer, &expected[i], mesh.vertex_count);
        compare_normals(name, instances[i].normal_buffer, &expected[i], mesh.vertex_count);
        free_shape(expected[i]);
        pliant_gl_instance_free(&instances[i]);
    }
    pliant_gl_mesh_free(&mesh);
    CHECK(glGetError() == GL_NO_ERROR, "%s: GL reports an error", name);
}

/* The first columns only; and a mesh without normals. */
static void check_columns(const opened* o, pliant_gl* gl, const char* name)
{
    made_normals adjacency = make_normals(&o->asset);
    pliant_gl_mesh mesh;
    pliant_gl_instance instance;
    uint64_t state = 73;
    float q[256];
    CHECK(pliant_gl_mesh_init(&mesh, gl, &o->asset, NULL) == PLIANT_GL_OK, "%s: without normals", name);
    CHECK(pliant_gl_instance_init(&instance, &mesh) == PLIANT_GL_OK && instance.normal_buffer == 0, "%s: no normals", name);
    for (uint32_t columns = 0; columns <= o->asset.dimension + 1; columns += 1 + o->asset.dimension / 4) {
        choose_q(&o->asset, &state, q);
        CHECK(pliant_gl_update_columns(&instance, q, columns) == PLIANT_GL_OK, "%s: %u columns", name, columns);
        for (uint32_t j = columns; j < o->asset.dimension; ++j) q[j] = 0.0f;
        const expected_shape e = expect_shape(&o->asset, &adjacency.normals, q);
        compare_positions(name, instance.position_buffer, &e, mesh.vertex_count);
        free_shape(e);
    }
    pliant_gl_instance_free(&instance);
    pliant_gl_mesh_free(&mesh);
    free(adjacency.memory);
}

/* ------------------------------------------------------------------------------------------------------ direct path ---- */

static void check_direct(const opened* o, pliant_gl* gl, const char* name)
{
    static const char main_text[]
        = "out vec3 place;\nvoid main() { place = pliant_position(gl_VertexID); gl_Position = vec4(0.0); }\n";
    const GLuint program
        = make_test_program(wished->is_es, pliant_gl_direct_source(), main_text, "void main() {}\n", "place");
    made_normals adjacency = make_normals(&o->asset);
    pliant_gl_mesh mesh;
    pliant_gl_locations locations;
    GLuint buffer, vertex_array;
    float q[256];
    uint64_t state = 79;
    CHECK(pliant_gl_mesh_init(&mesh, gl, &o->asset, NULL) == PLIANT_GL_OK, "%s: direct", name);
    CHECK(pliant_gl_direct_locate(gl, program, &locations) == PLIANT_GL_OK, "%s: locations", name);
    glGenVertexArrays(1, &vertex_array);
    glBindVertexArray(vertex_array);
    glGenBuffers(1, &buffer);
    glBindBuffer(GL_COPY_WRITE_BUFFER, buffer);
    glBufferData(GL_COPY_WRITE_BUFFER, (GLsizeiptr)mesh.vertex_count * 12, NULL, GL_DYNAMIC_COPY);
    choose_q(&o->asset, &state, q);
    glUseProgram(program);
    CHECK(pliant_gl_direct_bind(&mesh, &locations, 5, q, mesh.dimension) == PLIANT_GL_OK, "%s: bind", name);
    glEnable(GL_RASTERIZER_DISCARD);
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer);
    glBeginTransformFeedback(GL_POINTS);
    glDrawArrays(GL_POINTS, 0, (GLsizei)mesh.vertex_count);
    glEndTransformFeedback();
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
    glDisable(GL_RASTERIZER_DISCARD);
    const expected_shape e = expect_shape(&o->asset, &adjacency.normals, q);
    compare_positions("direct", buffer, &e, mesh.vertex_count);
    free_shape(e);
    glUseProgram(0);
    glDeleteProgram(program);
    glDeleteBuffers(1, &buffer);
    glBindVertexArray(0);
    glDeleteVertexArrays(1, &vertex_array);
    pliant_gl_mesh_free(&mesh);
    free(adjacency.memory);
    CHECK(glGetError() == GL_NO_ERROR, "%s: GL reports an error", name);
}

static void check_path(const opened* o, pliant_gl_path path, uint32_t texture_size)
{
    pliant_gl gl;
    char name[128];
    pliant_gl_desc desc = pliant_gl_desc_default();
    desc.path = path;
    desc.max_texture_size = texture_size;
    snprintf(name, sizeof name, "%s, %s, textures of %u", o->name, path == PLIANT_GL_PATH_COMPUTE ? "compute" : "feedback",
             texture_size);
    const pliant_gl_result result = pliant_gl_init(&gl, eglGetProcAddress, &desc);
    CHECK(result == PLIANT_GL_OK, "%s: %s: %s", name, pliant_gl_result_text(result), gl.message);
    if (result != PLIANT_GL_OK) return;
    CHECK(gl.path == path && gl.is_es == (uint32_t)wished->is_es, "%s: other path", name);
    check_instances(o, &gl, name);
    check_columns(o, &gl, name);
    check_direct(o, &gl, name);
    pliant_gl_free(&gl);
}

int main(int argc, char** argv)
{
    if (argc < 4) return 2;
    wished = find_wished(argv[1]);
    const test_context context = make_context(wished);
    make_canvas(4, 4);
    for (int i = 3; i < argc; ++i) {
        opened o = open_asset(argv[2], argv[i]);
        check_path(&o, PLIANT_GL_PATH_FEEDBACK, 0);
        check_path(&o, PLIANT_GL_PATH_FEEDBACK, 16);
        if (has_compute_shaders()) check_path(&o, PLIANT_GL_PATH_COMPUTE, 0);
        if (has_compute_shaders()) check_path(&o, PLIANT_GL_PATH_COMPUTE, 16);
        free_blob(o.blob);
    }
    drop_context(context);
    return report("paths");
}
