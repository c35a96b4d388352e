/* What positions and normals cost, on the processor and by each path of pliant_gl that the driver has: pliant_bench_gl
   ASSET... Best of 41 updates, each waited for (glFinish). Prints the renderer: with llvmpipe it is the processor that
   draws. */
#define _POSIX_C_SOURCE 200112L
#include "gl_test.h"

#include <time.h>

enum { REPEATS = 41 };

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

static double best(const double* times)
{
    double smallest = times[0];
    for (int i = 1; i < REPEATS; ++i) smallest = times[i] < smallest ? times[i] : smallest;
    return smallest;
}

static void bench_processor(const pliant_asset* asset, const pliant_normals* normals, const float* q)
{
    const uint32_t n = asset->boundary_vertex_count;
    float* positions = malloc((size_t)n * 24);
    double rebuild[REPEATS], gather[REPEATS], adjacency[REPEATS];
    const size_t size = pliant_normals_memory(asset);
    void* memory = malloc(size);
    if (!positions || !memory) exit(2);
    for (int i = 0; i < REPEATS; ++i) {
        pliant_normals again;
        const double start = now();
        pliant_reconstruct(asset, q, 0, n, positions, 12);
        const double between = now();
        pliant_normals_compute(normals, positions, 12, 0, n, positions + 3 * (size_t)n, 12);
        const double end = now();
        if (pliant_normals_init(&again, asset, memory, size) != PLIANT_OK) exit(2);
        rebuild[i] = between - start;
        gather[i] = end - between;
        adjacency[i] = now() - end;
    }
    printf(
        "processor, one core: positions %.3f ms, normals %.3f ms (%.1f ns a vertex); adjacency %.1f ms once, %.1f bytes a "
        "vertex (%.1f while it is made)\n",
        best(rebuild), best(gather), 1e6 * best(gather) / n, best(adjacency), (double)normals->memory_used / n,
        (double)size / n);
    free(memory);
    free(positions);
}

static void bench_update(pliant_gl* gl, const pliant_asset* asset, const pliant_normals* normals, const float* q,
                         const char* name)
{
    pliant_gl_mesh mesh;
    pliant_gl_instance instance;
    double times[REPEATS];
    if (pliant_gl_mesh_init(&mesh, gl, asset, normals) != PLIANT_GL_OK
        || pliant_gl_instance_init(&instance, &mesh) != PLIANT_GL_OK)
        exit(2);
    for (int i = -3; i < REPEATS; ++i) {
        glFinish();
        const double start = now();
        if (pliant_gl_update(&instance, q) != PLIANT_GL_OK) exit(2);
        glFinish();
        if (i >= 0) times[i] = now() - start;
    }
    printf("%s, %s: %.3f ms; %.1f bytes of GL memory a vertex once, %u an instance\n", name,
           normals ? "positions and normals" : "positions only", best(times), (double)mesh.byte_count / mesh.vertex_count,
           normals ? 24u : 12u);
    pliant_gl_instance_free(&instance);
    pliant_gl_mesh_free(&mesh);
}

/* Points of no size, drawn nowhere: what the caller's vertex shader pays for positions in every pass. */
static void bench_direct(pliant_gl* gl, const pliant_asset* asset, const float* q)
{
    const GLuint program = make_test_program(gl->is_es, pliant_gl_direct_source(),
                                             "void main() { gl_Position = vec4(pliant_position(gl_VertexID), 1.0); }\n",
                                             "void main() {}\n", NULL);
    pliant_gl_mesh mesh;
    pliant_gl_locations locations;
    GLuint vertex_array;
    double times[REPEATS];
    if (pliant_gl_mesh_init(&mesh, gl, asset, NULL) != PLIANT_GL_OK) exit(2);
    pliant_gl_direct_locate(gl, program, &locations);
    glGenVertexArrays(1, &vertex_array);
    glBindVertexArray(vertex_array);
    glUseProgram(program);
    glEnable(GL_RASTERIZER_DISCARD);
    for (int i = -3; i < REPEATS; ++i) {
        glFinish();
        const double start = now();
        pliant_gl_direct_bind(&mesh, &locations, 0, q, mesh.dimension);
        glDrawArrays(GL_POINTS, 0, (GLsizei)mesh.vertex_count);
        glFinish();
        if (i >= 0) times[i] = now() - start;
    }
    glDisable(GL_RASTERIZER_DISCARD);
    printf("direct: %.3f ms for every pass\n", best(times));
    glUseProgram(0);
    glBindVertexArray(0);
    pliant_gl_mesh_free(&mesh);
}

static void bench_asset(const char* path)
{
    static const char* const names[] = { NULL, "transform feedback", "compute shader" };
    blob_file blob = read_blob(path);
    pliant_asset asset;
    if (pliant_asset_open(&asset, blob.data, blob.size, PLIANT_OPEN_DEFAULT) != PLIANT_OK) {
        fprintf(stderr, "%s does not open\n", path);
        exit(2);
    }
    const made_normals adjacency = make_normals(&asset);
    const float* q = pliant_asset_pose_coordinates(&asset, asset.pose_count - 1);
    printf("\n%s: %u vertices, %u triangles, d = %u\n", path, asset.boundary_vertex_count, asset.triangle_count,
           asset.dimension);
    bench_processor(&asset, &adjacency.normals, q);
    for (int path_number = 1; path_number <= 2; ++path_number) {
        pliant_gl gl;
        pliant_gl_desc desc = pliant_gl_desc_default();
        desc.path = (pliant_gl_path)path_number;
        if (pliant_gl_init(&gl, eglGetProcAddress, &desc) != PLIANT_GL_OK) continue;
        bench_update(&gl, &asset, NULL, q, names[path_number]);
        bench_update(&gl, &asset, &adjacency.normals, q, names[path_number]);
        if (path_number == 1) bench_direct(&gl, &asset, q);
        pliant_gl_free(&gl);
    }
    free(adjacency.memory);
    free_blob(blob);
}

int main(int argc, char** argv)
{
    const test_context context = make_context(find_wished("gl43"));
    make_canvas(4, 4);
    for (int i = 1; i < argc; ++i) bench_asset(argv[i]);
    drop_context(context);
    return argc > 1 ? 0 : 2;
}
