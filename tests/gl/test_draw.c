/* Draws what pliant_gl made: a depth pass and a shaded pass from one update, as a game would, and the direct path. The
   pictures are those that buffers filled by the processor give. test_draw CONTEXT FOLDER ASSET [PICTURE.ppm]: with a name
   the picture is kept. */
#include "gl_test.h"

#include <math.h>

enum { SIZE = 256 };

/* Looks along -z at the middle of the shape, orthographic; the near side has the largest z. */
#define VIEW_TEXT                                                     \
    "uniform vec4 view;\n" /* middle, and 1 / half of what is seen */ \
    "vec4 seen(vec3 p) { vec3 r = (p - view.xyz) * view.w; return vec4(r.x, r.y, -r.z, 1.0); }\n"

static const char vertex_text[] = "in vec3 position;\nin vec3 normal;\nout vec3 direction;\n"
                                  "void main() { direction = normal; gl_Position = seen(position); }\n";
static const char fragment_text[] = "in vec3 direction;\nout vec4 colour;\n"
                                    "void main() { float d = dot(normalize(direction), normalize(vec3(0.4, 0.6, 0.7)));\n"
                                    "  colour = vec4(vec3(0.9, 0.7, 0.5) * (0.25 + 0.75 * abs(d)), 1.0); }\n";
static const char direct_text[]
    = "out vec3 direction;\nvoid main() { vec3 p = pliant_position(gl_VertexID); direction = vec3(0.4, 0.6, 0.7);\n"
      "  gl_Position = seen(p); }\n";

typedef struct scene {
    const pliant_asset* asset;
    const float* q;
    float view[4];
    GLuint vertex_array, index_buffer;
    GLsizei index_count;
} scene;

static unsigned char* draw(const scene* s, GLuint program, int depth_first)
{
    unsigned char* pixels = malloc(4 * SIZE * SIZE);
    if (!pixels) exit(2);
    glClearColor(0.1f, 0.1f, 0.15f, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glUseProgram(program);
    glUniform4fv(glGetUniformLocation(program, "view"), 1, s->view);
    glBindVertexArray(s->vertex_array);
    if (depth_first) {
        glColorMask(0, 0, 0, 0);
        glDrawElements(GL_TRIANGLES, s->index_count, GL_UNSIGNED_INT, NULL);
        glColorMask(1, 1, 1, 1);
    }
    glDrawElements(GL_TRIANGLES, s->index_count, GL_UNSIGNED_INT, NULL);
    glReadPixels(0, 0, SIZE, SIZE, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
    return pixels;
}

/* A picture is the other one if all but a few pixels (edges, where rounding decides) differ by no more than 4 of 255. */
static void expect_same(const unsigned char* a, const unsigned char* b, const char* name)
{
    int different = 0, drawn = 0;
    for (int i = 0; i < 4 * SIZE * SIZE; i += 4) {
        int largest = 0;
        for (int c = 0; c < 3; ++c) largest = abs(a[i + c] - b[i + c]) > largest ? abs(a[i + c] - b[i + c]) : largest;
        different += largest > 4;
        drawn += b[i] > 60;
    }
    CHECK(drawn > SIZE * SIZE / 50, "%s: only %d pixels are drawn", name, drawn);
    CHECK(different <= drawn / 200, "%s: %d of %d pixels differ", name, different, drawn);
}

static void keep(const unsigned char* pixels, const char* path)
{
    FILE* file = fopen(path, "wb");
    if (!file) exit(2);
    fprintf(file, "P6\n%d %d\n255\n", SIZE, SIZE);
    for (int y = SIZE - 1; y >= 0; --y)
        for (int x = 0; x < SIZE; ++x) fwrite(pixels + 4 * (y * SIZE + x), 1, 3, file);
    fclose(file);
}

static void choose_view(scene* s, const float* positions)
{
    float low[3], high[3], half = 0.0f;
    for (int c = 0; c < 3; ++c) low[c] = high[c] = positions[c];
    for (uint32_t i = 0; i < 3 * s->asset->boundary_vertex_count; ++i) {
        low[i % 3] = fminf(low[i % 3], positions[i]);
        high[i % 3] = fmaxf(high[i % 3], positions[i]);
    }
    for (int c = 0; c < 3; ++c) {
        s->view[c] = (low[c] + high[c]) / 2.0f;
        half = fmaxf(half, (high[c] - low[c]) / 2.0f);
    }
    s->view[3] = 0.95f / half;
}

/* What the processor gives, drawn from buffers of the test's own. */
static unsigned char* draw_expected(scene* s, const pliant_normals* normals, GLuint program)
{
    const uint32_t n = s->asset->boundary_vertex_count;
    float* both = malloc((size_t)n * 24);
    GLuint buffers[2];
    if (!both) exit(2);
    pliant_reconstruct(s->asset, s->q, 0, n, both, 24);
    pliant_normals_compute(normals, both, 24, 0, n, both + 3, 24);
    float* positions = malloc((size_t)n * 12);
    if (!positions) exit(2);
    pliant_reconstruct(s->asset, s->q, 0, n, positions, 12);
    choose_view(s, positions);
    glGenVertexArrays(1, &s->vertex_array);
    glBindVertexArray(s->vertex_array);
    glGenBuffers(2, buffers);
    glBindBuffer(GL_ARRAY_BUFFER, buffers[0]);
    glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)n * 24, both, GL_STATIC_DRAW);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)s->asset->triangle_count * 12, s->asset->triangles, GL_STATIC_DRAW);
    for (uint32_t i = 0; i < 2; ++i) {
        const GLint location = glGetAttribLocation(program, i ? "normal" : "position");
        glVertexAttribPointer((GLuint)location, 3, GL_FLOAT, GL_FALSE, 24, (const void*)(uintptr_t)(12 * i));
        glEnableVertexAttribArray((GLuint)location);
    }
    free(positions);
    free(both);
    return draw(s, program, 0);
}

static void check_buffers(scene* s, pliant_gl* gl, const pliant_normals* normals, const char* path)
{
    const GLuint program = make_test_program(gl->is_es, VIEW_TEXT, vertex_text, fragment_text, NULL);
    pliant_gl_mesh mesh;
    pliant_gl_instance instance;
    s->index_count = (GLsizei)(3 * s->asset->triangle_count);
    unsigned char* expected = draw_expected(s, normals, program);
    CHECK(pliant_gl_mesh_init(&mesh, gl, s->asset, normals) == PLIANT_GL_OK, "%s", gl->message);
    CHECK(pliant_gl_instance_init(&instance, &mesh) == PLIANT_GL_OK, "instance");
    glGenVertexArrays(1, &s->vertex_array);
    glBindVertexArray(s->vertex_array);
    CHECK(pliant_gl_bind_attributes(&instance, glGetAttribLocation(program, "position"),
                                    glGetAttribLocation(program, "normal"))
              == PLIANT_GL_OK,
          "attributes");
    glBindVertexArray(0);
    CHECK(pliant_gl_update(&instance, s->q) == PLIANT_GL_OK, "update");
    unsigned char* pixels = draw(s, program, 1);
    expect_same(pixels, expected, "buffers");
    if (path) keep(pixels, path);
    free(pixels);
    free(expected);
    pliant_gl_instance_free(&instance);
    pliant_gl_mesh_free(&mesh);
}

/* Without buffers: the silhouette is that of the buffers, in one colour. */
static void check_direct(scene* s, pliant_gl* gl)
{
    char head[16384];
    pliant_gl_mesh mesh;
    pliant_gl_locations locations;
    snprintf(head, sizeof head, "#define PLIANT_MAX_DIMENSION %u\n%s%s", s->asset->dimension, pliant_gl_direct_source(),
             VIEW_TEXT);
    const GLuint program = make_test_program(gl->is_es, head, direct_text, fragment_text, NULL);
    const GLuint flat
        = make_test_program(gl->is_es, VIEW_TEXT,
                            "in vec3 position;\nout vec3 direction;\nvoid main() { direction = vec3(0.4, 0.6, 0.7); "
                            "gl_Position = seen(position); }\n",
                            fragment_text, NULL);
    pliant_gl_instance instance;
    GLuint arrays[2];
    CHECK(pliant_gl_mesh_init(&mesh, gl, s->asset, NULL) == PLIANT_GL_OK, "mesh");
    CHECK(pliant_gl_instance_init(&instance, &mesh) == PLIANT_GL_OK, "instance");
    CHECK(pliant_gl_update(&instance, s->q) == PLIANT_GL_OK, "update");
    glGenVertexArrays(2, arrays);
    glBindVertexArray(arrays[0]);
    CHECK(pliant_gl_bind_attributes(&instance, glGetAttribLocation(flat, "position"), -1) == PLIANT_GL_OK, "attributes");
    glBindVertexArray(arrays[1]);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, mesh.index_buffer);
    s->vertex_array = arrays[0];
    unsigned char* expected = draw(s, flat, 0);
    s->vertex_array = arrays[1];
    CHECK(pliant_gl_direct_locate(gl, program, &locations) == PLIANT_GL_OK, "locations");
    glUseProgram(program);
    CHECK(pliant_gl_direct_bind(&mesh, &locations, 3, s->q, mesh.dimension) == PLIANT_GL_OK, "bind");
    unsigned char* pixels = draw(s, program, 1);
    expect_same(pixels, expected, "direct");
    free(pixels);
    free(expected);
    pliant_gl_instance_free(&instance);
    pliant_gl_mesh_free(&mesh);
}

int main(int argc, char** argv)
{
    if (argc != 4 && argc != 5) return 2;
    const wished_context* wished = find_wished(argv[1]);
    const test_context context = make_context(wished);
    opened o = open_asset(argv[2], argv[3]);
    made_normals adjacency = make_normals(&o.asset);
    scene s;
    pliant_gl gl;
    memset(&s, 0, sizeof s);
    make_canvas(SIZE, SIZE);
    CHECK(pliant_gl_init(&gl, eglGetProcAddress, NULL) == PLIANT_GL_OK, "%s", gl.message);
    s.asset = &o.asset;
    s.q = pliant_asset_pose_coordinates(&o.asset, o.asset.pose_count - 1);
    check_buffers(&s, &gl, &adjacency.normals, argc == 5 ? argv[4] : NULL);
    check_direct(&s, &gl);
    CHECK(glGetError() == GL_NO_ERROR, "GL reports an error");
    pliant_gl_free(&gl);
    free(adjacency.memory);
    free_blob(o.blob);
    drop_context(context);
    return report("draw");
}
