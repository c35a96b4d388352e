/* What pliant_gl answers to wrong calls, old contexts, missing functions, refused shaders, small limits; and that every call
   leaves GL's state as it was. Run once for each kind of context: test_calls CONTEXT FOLDER (with tube_neo and large). */
#include "gl_test.h"

static const wished_context* wished;

/* ---------------------------------------------------------------------------------------------- contexts that fail ---- */

static const char* pretended_version;
static const char* missing_function;

static const GLubyte* pretend_string(GLenum name)
{
    return name == GL_VERSION ? (const GLubyte*)pretended_version : (const GLubyte*)"";
}

static void spoil_shader(GLuint shader, GLsizei count, const char* const* texts, const GLint* lengths)
{
    static const char* const nonsense[1] = { "this is no shader\n" };
    (void)count;
    (void)texts;
    (void)lengths;
    glShaderSource(shader, 1, nonsense, NULL);
}

static pliant_gl_function load_pretender(const char* name)
{
    return strcmp(name, "glGetString") == 0 ? (pliant_gl_function)pretend_string
                                            : (pliant_gl_function)eglGetProcAddress(name);
}

static pliant_gl_function load_without(const char* name)
{
    return strcmp(name, missing_function) == 0 ? NULL : (pliant_gl_function)eglGetProcAddress(name);
}

static pliant_gl_function load_spoiled(const char* name)
{
    return strcmp(name, "glShaderSource") == 0 ? (pliant_gl_function)spoil_shader
                                               : (pliant_gl_function)eglGetProcAddress(name);
}

static void expect_context_error(pliant_gl_loader load, pliant_gl_path path, const char* in_message)
{
    pliant_gl gl;
    pliant_gl_desc desc = pliant_gl_desc_default();
    desc.path = path;
    const pliant_gl_result result = pliant_gl_init(&gl, load, &desc);
    CHECK(result == PLIANT_GL_ERROR_CONTEXT, "%s: %s", in_message, pliant_gl_result_text(result));
    CHECK(strstr(gl.message, in_message) != NULL, "%s: the message is \"%s\"", in_message, gl.message);
    CHECK(gl.version == 0 && gl.position_program == 0, "%s: something is left", in_message);
    pliant_gl_free(&gl);
}

static void check_contexts(void)
{
    static const char* const old[]
        = { "2.1 Mesa 22.3.6", "3.2 (Core Profile)", "1.4", "OpenGL ES 2.0 something", "OpenGL ES-CM 1.1", "", "nonsense" };
    static const char* const without_compute[] = { "3.3.0", "4.2 (Core Profile) Mesa", "OpenGL ES 3.0" };
    for (size_t i = 0; i < sizeof old / sizeof *old; ++i) {
        pretended_version = old[i];
        expect_context_error(load_pretender, PLIANT_GL_PATH_AUTO, "is needed, this is ");
    }
    for (size_t i = 0; i < sizeof without_compute / sizeof *without_compute; ++i) {
        pretended_version = without_compute[i];
        expect_context_error(load_pretender, PLIANT_GL_PATH_COMPUTE, "compute shaders need");
    }
    pretended_version = NULL;
    expect_context_error(load_pretender, PLIANT_GL_PATH_AUTO, "no context");
    missing_function = "glGetString";
    expect_context_error(load_without, PLIANT_GL_PATH_AUTO, "glGetString");
    missing_function = "glTransformFeedbackVaryings";
    expect_context_error(load_without, PLIANT_GL_PATH_FEEDBACK, "glTransformFeedbackVaryings");
    if (!has_compute_shaders()) expect_context_error(eglGetProcAddress, PLIANT_GL_PATH_COMPUTE, "compute shaders need");

    pliant_gl gl;
    CHECK(pliant_gl_init(&gl, load_spoiled, NULL) == PLIANT_GL_ERROR_SHADER, "a shader that is nonsense");
    CHECK(strlen(gl.message) > 10, "the driver's words are missing: \"%s\"", gl.message);
}

/* -------------------------------------------------------------------------------------------------- wrong arguments ---- */

static void check_results(void)
{
    static const pliant_gl_result all[] = { PLIANT_GL_OK,           PLIANT_GL_ERROR_ARGUMENT, PLIANT_GL_ERROR_CONTEXT,
                                            PLIANT_GL_ERROR_SHADER, PLIANT_GL_ERROR_LIMIT,    PLIANT_GL_ERROR_MEMORY };
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i)
        CHECK(strcmp(pliant_gl_result_text(all[i]), "unknown result code") != 0, "result %d has no text", (int)all[i]);
    CHECK(strcmp(pliant_gl_result_text((pliant_gl_result)999), "unknown result code") == 0, "result 999");
}

static void check_init_arguments(void)
{
    pliant_gl gl;
    pliant_gl_desc desc = pliant_gl_desc_default();
    CHECK(pliant_gl_init(NULL, eglGetProcAddress, NULL) == PLIANT_GL_ERROR_ARGUMENT, "nowhere to put it");
    CHECK(pliant_gl_init(&gl, NULL, NULL) == PLIANT_GL_ERROR_ARGUMENT, "no loader");
    desc.struct_size = 0;
    CHECK(pliant_gl_init(&gl, eglGetProcAddress, &desc) == PLIANT_GL_ERROR_ARGUMENT, "a desc not made by its function");
    desc = pliant_gl_desc_default();
    desc.path = (pliant_gl_path)7;
    CHECK(pliant_gl_init(&gl, eglGetProcAddress, &desc) == PLIANT_GL_ERROR_ARGUMENT, "no such path");
    desc.path = PLIANT_GL_PATH_AUTO;
    desc.max_texture_size = 24;
    CHECK(pliant_gl_init(&gl, eglGetProcAddress, &desc) == PLIANT_GL_ERROR_ARGUMENT, "not a power of two");
    pliant_gl_free(&gl);
    pliant_gl_free(NULL);
}

static void check_arguments(pliant_gl* gl, const opened* o, const opened* other)
{
    made_normals adjacency = make_normals(&o->asset), foreign = make_normals(&other->asset);
    pliant_gl nothing;
    pliant_gl_mesh mesh, bare;
    pliant_gl_instance instance, plain;
    pliant_gl_locations locations;
    float q[256] = { 0 };
    memset(&nothing, 0, sizeof nothing);
    CHECK(pliant_gl_mesh_init(NULL, gl, &o->asset, NULL) == PLIANT_GL_ERROR_ARGUMENT, "nowhere to put a mesh");
    CHECK(pliant_gl_mesh_init(&mesh, NULL, &o->asset, NULL) == PLIANT_GL_ERROR_ARGUMENT, "no context");
    CHECK(pliant_gl_mesh_init(&mesh, &nothing, &o->asset, NULL) == PLIANT_GL_ERROR_ARGUMENT, "a context not made");
    CHECK(pliant_gl_mesh_init(&mesh, gl, NULL, NULL) == PLIANT_GL_ERROR_ARGUMENT, "no asset");
    CHECK(pliant_gl_mesh_init(&mesh, gl, &o->asset, &foreign.normals) == PLIANT_GL_ERROR_ARGUMENT, "adjacency of another");
    CHECK(mesh.vertex_count == 0 && mesh.shape_texture == 0, "a failed mesh leaves something");
    CHECK(pliant_gl_instance_init(&instance, &mesh) == PLIANT_GL_ERROR_ARGUMENT, "an instance of nothing");
    CHECK(pliant_gl_instance_init(&instance, NULL) == PLIANT_GL_ERROR_ARGUMENT, "an instance of null");
    CHECK(pliant_gl_update(&instance, q) == PLIANT_GL_ERROR_ARGUMENT, "an instance that was not made");
    CHECK(pliant_gl_mesh_init(&mesh, gl, &o->asset, &adjacency.normals) == PLIANT_GL_OK, "mesh");
    CHECK(pliant_gl_mesh_init(&bare, gl, &o->asset, NULL) == PLIANT_GL_OK, "mesh without normals");
    CHECK(mesh.index_count == 3 * o->asset.triangle_count && mesh.byte_count > bare.byte_count,
          "what a mesh says of itself");
    CHECK(pliant_gl_instance_init(NULL, &mesh) == PLIANT_GL_ERROR_ARGUMENT, "nowhere to put an instance");
    CHECK(pliant_gl_instance_init(&instance, &mesh) == PLIANT_GL_OK, "instance");
    CHECK(pliant_gl_instance_init(&plain, &bare) == PLIANT_GL_OK, "instance without normals");
    CHECK(pliant_gl_update(NULL, q) == PLIANT_GL_ERROR_ARGUMENT, "no instance");
    CHECK(pliant_gl_update(&instance, NULL) == PLIANT_GL_ERROR_ARGUMENT, "no q");
    CHECK(pliant_gl_bind_attributes(NULL, 0, 1) == PLIANT_GL_ERROR_ARGUMENT, "attributes of nothing");
    CHECK(pliant_gl_bind_attributes(&plain, 0, 1) == PLIANT_GL_ERROR_ARGUMENT, "normals that are not there");
    CHECK(pliant_gl_direct_locate(gl, 0, &locations) == PLIANT_GL_ERROR_ARGUMENT, "no program");
    CHECK(pliant_gl_direct_bind(NULL, &locations, 0, q, 1) == PLIANT_GL_ERROR_ARGUMENT, "no mesh");
    pliant_gl_instance_free(&plain);
    pliant_gl_instance_free(&instance);
    CHECK(pliant_gl_update(&instance, q) == PLIANT_GL_ERROR_ARGUMENT, "an instance that was freed");
    pliant_gl_instance_free(&instance);
    pliant_gl_instance_free(NULL);
    pliant_gl_mesh_free(&bare);
    pliant_gl_mesh_free(&mesh);
    pliant_gl_mesh_free(&mesh);
    pliant_gl_mesh_free(NULL);
    CHECK(glGetError() == GL_NO_ERROR, "GL reports an error");
    free(adjacency.memory);
    free(foreign.memory);
}

/* Too large for textures of 16 rows and a layer or two. Which part does not fit changes with the number of layers. */
static void check_limits(const opened* large)
{
    made_normals adjacency = make_normals(&large->asset);
    int refused = 0, accepted = 0;
    for (uint32_t layers = 1; layers <= 64; layers *= 2) {
        pliant_gl gl;
        pliant_gl_mesh mesh;
        pliant_gl_desc desc = pliant_gl_desc_default();
        desc.path = PLIANT_GL_PATH_FEEDBACK;
        desc.max_texture_size = 16;
        desc.max_layers = layers;
        CHECK(pliant_gl_init(&gl, eglGetProcAddress, &desc) == PLIANT_GL_OK, "%u layers", layers);
        const pliant_gl_result result = pliant_gl_mesh_init(&mesh, &gl, &large->asset, &adjacency.normals);
        CHECK(result == PLIANT_GL_OK || result == PLIANT_GL_ERROR_LIMIT, "%u layers: %s", layers,
              pliant_gl_result_text(result));
        CHECK(result == PLIANT_GL_OK || mesh.vertex_count == 0, "%u layers: something is left", layers);
        refused += result == PLIANT_GL_ERROR_LIMIT;
        accepted += result == PLIANT_GL_OK;
        pliant_gl_mesh_free(&mesh);
        pliant_gl_free(&gl);
    }
    CHECK(refused > 0 && accepted > 0, "%d refused, %d accepted", refused, accepted);
    free(adjacency.memory);
}

/* ------------------------------------------------------------------------------------------------------- state ---- */

enum { STATES = 40 };

static const GLenum watched[] = { GL_CURRENT_PROGRAM,
                                  GL_VERTEX_ARRAY_BINDING,
                                  GL_ARRAY_BUFFER_BINDING,
                                  GL_ELEMENT_ARRAY_BUFFER_BINDING,
                                  GL_ACTIVE_TEXTURE,
                                  GL_COPY_WRITE_BUFFER,
                                  GL_PIXEL_UNPACK_BUFFER_BINDING,
                                  GL_UNPACK_ALIGNMENT,
                                  GL_UNPACK_ROW_LENGTH,
                                  GL_UNPACK_SKIP_ROWS,
                                  GL_UNPACK_SKIP_PIXELS,
                                  GL_UNPACK_SKIP_IMAGES,
                                  GL_UNPACK_IMAGE_HEIGHT,
                                  GL_FRAMEBUFFER_BINDING,
                                  GL_TRANSFORM_FEEDBACK_BUFFER_BINDING,
                                  GL_RASTERIZER_DISCARD,
                                  GL_UNIFORM_BUFFER_BINDING };
enum { WATCHED = sizeof watched / sizeof *watched };

/* What GL says of itself, in an order of our own. */
static void take_down(GLint* state)
{
    int at = 0;
    memset(state, 0, STATES * sizeof *state);
    for (int i = 0; i < WATCHED; ++i) glGetIntegerv(watched[i], &state[at++]);
    if (!wished->is_es) glGetIntegerv(GL_UNPACK_SWAP_BYTES, &state[at++]);
    glGetIntegeri_v(GL_TRANSFORM_FEEDBACK_BUFFER_BINDING, 0, &state[at++]);
    glGetIntegeri_v(GL_TRANSFORM_FEEDBACK_BUFFER_START, 0, &state[at++]);
    glGetIntegeri_v(GL_TRANSFORM_FEEDBACK_BUFFER_SIZE, 0, &state[at++]);
    for (GLuint i = 0; has_compute_shaders() && i < 2; ++i) {
        glGetIntegeri_v(GL_SHADER_STORAGE_BUFFER_BINDING, i, &state[at++]);
        glGetIntegeri_v(GL_SHADER_STORAGE_BUFFER_START, i, &state[at++]);
        glGetIntegeri_v(GL_SHADER_STORAGE_BUFFER_SIZE, i, &state[at++]);
    }
    if (has_compute_shaders()) glGetIntegerv(GL_SHADER_STORAGE_BUFFER_BINDING, &state[at++]);
    for (GLuint unit = 0; unit < 3; ++unit) {
        glActiveTexture(GL_TEXTURE0 + unit);
        glGetIntegerv(GL_TEXTURE_BINDING_2D_ARRAY, &state[at++]);
        glGetIntegerv(GL_SAMPLER_BINDING, &state[at++]);
    }
    glActiveTexture((GLenum)state[4]);
}

static void expect_state(const GLint* before, const char* after_what)
{
    GLint now[STATES];
    take_down(now);
    for (int i = 0; i < STATES; ++i)
        CHECK(now[i] == before[i], "%s: state %d is %d, was %d", after_what, i, now[i], before[i]);
}

/* Everything set to something that a forgetful caller might have. */
static void set_unusual_state(void)
{
    GLuint textures[3], samplers[3], buffers[4], vertex_array;
    glGenTextures(3, textures);
    glGenSamplers(3, samplers);
    for (GLuint unit = 0; unit < 3; ++unit) {
        glActiveTexture(GL_TEXTURE0 + unit);
        glBindTexture(GL_TEXTURE_2D_ARRAY, textures[unit]);
        glSamplerParameteri(samplers[unit], GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
        glSamplerParameteri(samplers[unit], GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        glBindSampler(unit, samplers[unit]);
    }
    glGenBuffers(4, buffers);
    for (int i = 0; i < 4; ++i) {
        glBindBuffer(GL_ARRAY_BUFFER, buffers[i]);
        glBufferData(GL_ARRAY_BUFFER, 4096, NULL, GL_STATIC_DRAW);
    }
    glGenVertexArrays(1, &vertex_array);
    glBindVertexArray(vertex_array);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
    glBindBuffer(GL_COPY_WRITE_BUFFER, buffers[2]);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffers[3]);
    glBindBufferRange(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffers[0], 256, 512);
    if (has_compute_shaders()) {
        glBindBufferRange(GL_SHADER_STORAGE_BUFFER, 0, buffers[1], 1024, 256);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, buffers[2]);
    }
    glPixelStorei(GL_UNPACK_ALIGNMENT, 8);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 77);
    glPixelStorei(GL_UNPACK_SKIP_ROWS, 3);
    glPixelStorei(GL_UNPACK_SKIP_PIXELS, 5);
    glPixelStorei(GL_UNPACK_SKIP_IMAGES, 1);
    glPixelStorei(GL_UNPACK_IMAGE_HEIGHT, 99);
    if (!wished->is_es) glPixelStorei(GL_UNPACK_SWAP_BYTES, 1);
    glUseProgram(
        make_test_program(wished->is_es, "", "void main() { gl_Position = vec4(0.0); }\n", "void main() {}\n", NULL));
    glActiveTexture(GL_TEXTURE0 + 2);
}

static float largest_difference(GLuint buffer, const float* expected, size_t count)
{
    float* found = read_buffer(buffer, count);
    float largest = 0.0f;
    for (size_t i = 0; i < 3 * count; ++i) {
        const float difference = found[i] > expected[i] ? found[i] - expected[i] : expected[i] - found[i];
        if (!(difference <= largest)) largest = difference;
    }
    free(found);
    return largest;
}

static void check_state(const opened* o, pliant_gl_path path)
{
    made_normals adjacency = make_normals(&o->asset);
    const float* q = pliant_asset_pose_coordinates(&o->asset, 1);
    const uint32_t n = o->asset.boundary_vertex_count;
    float* positions = malloc((size_t)n * 24);
    pliant_gl gl;
    pliant_gl_mesh mesh;
    pliant_gl_instance instance;
    GLint before[STATES];
    pliant_gl_desc desc = pliant_gl_desc_default();
    if (!positions) exit(2);
    desc.path = path;
    take_down(before);
    CHECK(pliant_gl_init(&gl, eglGetProcAddress, &desc) == PLIANT_GL_OK, "%s", gl.message);
    expect_state(before, "init");
    CHECK(pliant_gl_mesh_init(&mesh, &gl, &o->asset, &adjacency.normals) == PLIANT_GL_OK, "mesh");
    expect_state(before, "mesh_init");
    CHECK(pliant_gl_instance_init(&instance, &mesh) == PLIANT_GL_OK, "instance");
    expect_state(before, "instance_init");
    CHECK(pliant_gl_update(&instance, q) == PLIANT_GL_OK, "update");
    expect_state(before, "update");
    CHECK(glGetError() == GL_NO_ERROR, "GL reports an error");
    pliant_reconstruct(&o->asset, q, 0, n, positions, 12);
    pliant_normals_compute(&adjacency.normals, positions, 12, 0, n, positions + 3 * (size_t)n, 12);
    CHECK(largest_difference(instance.position_buffer, positions, n) < 1e-4f, "positions under an unusual state");
    CHECK(largest_difference(instance.normal_buffer, positions + 3 * (size_t)n, n) < 1e-2f,
          "normals under an unusual state");
    pliant_gl_instance_free(&instance);
    pliant_gl_mesh_free(&mesh);
    pliant_gl_free(&gl);
    free(positions);
    free(adjacency.memory);
}

int main(int argc, char** argv)
{
    if (argc != 3) return 2;
    wished = find_wished(argv[1]);
    const test_context context = make_context(wished);
    opened small = open_asset(argv[2], "tube_neo"), large = open_asset(argv[2], "large");
    pliant_gl gl;
    make_canvas(4, 4);
    check_results();
    check_contexts();
    check_init_arguments();
    CHECK(pliant_gl_init(&gl, eglGetProcAddress, NULL) == PLIANT_GL_OK, "%s", gl.message);
    CHECK(gl.path == (has_compute_shaders() ? PLIANT_GL_PATH_COMPUTE : PLIANT_GL_PATH_FEEDBACK),
          "the path of its own choice");
    check_arguments(&gl, &small, &large);
    pliant_gl_free(&gl);
    check_limits(&large);
    set_unusual_state();
    check_state(&small, PLIANT_GL_PATH_FEEDBACK);
    if (has_compute_shaders()) check_state(&small, PLIANT_GL_PATH_COMPUTE);
    free_blob(small.blob);
    free_blob(large.blob);
    drop_context(context);
    return report("calls");
}
