/* pliant_gl: contexts and instances. Meshes are in pliant_gl_mesh.c, shaders in pliant_gl_shaders.c, what is put back after
   each call in pliant_gl_state.c. */
#include "pliant_gl_internal.h"

/* A compile-time check that the struct of the header has a place for every function. */
typedef char function_count_is_right[PLIANT_GL_INDEX_COUNT == PLIANT_GL_FUNCTION_COUNT ? 1 : -1];

const char* pliant_gl_result_text(pliant_gl_result result)
{
    switch (result) {
    case PLIANT_GL_OK: return "success";
    case PLIANT_GL_ERROR_ARGUMENT:
        return "bad argument: a null pointer, an object that was not made, or an adjacency of another asset";
    case PLIANT_GL_ERROR_CONTEXT: return "this context cannot do it: OpenGL 3.3 core or OpenGL ES 3.0 is needed";
    case PLIANT_GL_ERROR_SHADER: return "the driver refuses a shader";
    case PLIANT_GL_ERROR_LIMIT: return "the mesh is larger than this context's textures";
    case PLIANT_GL_ERROR_MEMORY: return "the driver is out of memory or reports an error";
    }
    return "unknown result code";
}

pliant_gl_desc pliant_gl_desc_default(void)
{
    pliant_gl_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.struct_size = sizeof desc;
    return desc;
}

/* --------------------------------------------------------------------------------------------------------- context ---- */

/* "4.5 (Core Profile) Mesa ..." or "OpenGL ES 3.2 ...": asking for GL_MAJOR_VERSION would be an error before 3.0. */
static void parse_version(pliant_gl* gl, const char* text)
{
    static const char es[] = "OpenGL ES ";
    gl->is_es = strncmp(text, es, sizeof es - 1) == 0;
    if (gl->is_es) text += sizeof es - 1;
    if (text[0] >= '0' && text[0] <= '9' && text[1] == '.' && text[2] >= '0' && text[2] <= '9')
        gl->version = (uint32_t)(text[0] - '0') * 10 + (uint32_t)(text[2] - '0');
}

static pliant_gl_result load_functions(pliant_gl* gl, pliant_gl_loader load, uint32_t first, uint32_t end)
{
#define PLIANT_GL_NAME(result, name, parameters) "gl" #name,
    static const char* const names[] = { PLIANT_GL_FUNCTIONS(PLIANT_GL_NAME) };
#undef PLIANT_GL_NAME
    for (uint32_t i = first; i < end; ++i) {
        gl->functions[i] = load(names[i]);
        if (!gl->functions[i]) {
            pliant_gl_say(gl, "the loader has no ", names[i]);
            return PLIANT_GL_ERROR_CONTEXT;
        }
    }
    return PLIANT_GL_OK;
}

static pliant_gl_result choose_path(pliant_gl* gl, pliant_gl_path wished)
{
    const int can_compute = gl->version >= (gl->is_es ? 31u : 43u);
    if (gl->version < (gl->is_es ? 30u : 33u)) {
        pliant_gl_say(gl, "OpenGL 3.3 core or OpenGL ES 3.0 is needed, this is ",
                      (const char*)GL(gl, GetString)(GL_VERSION));
        return PLIANT_GL_ERROR_CONTEXT;
    }
    if (wished == PLIANT_GL_PATH_COMPUTE && !can_compute) {
        pliant_gl_say(gl, "compute shaders need OpenGL 4.3 or OpenGL ES 3.1, this is ",
                      (const char*)GL(gl, GetString)(GL_VERSION));
        return PLIANT_GL_ERROR_CONTEXT;
    }
    gl->path = can_compute && wished != PLIANT_GL_PATH_FEEDBACK ? PLIANT_GL_PATH_COMPUTE : PLIANT_GL_PATH_FEEDBACK;
    return PLIANT_GL_OK;
}

static pliant_gl_result load_context(pliant_gl* gl, pliant_gl_loader load, pliant_gl_path wished)
{
    pliant_gl_result result = load_functions(gl, load, PLIANT_GL_INDEX_GetString, PLIANT_GL_INDEX_GetString + 1);
    if (result != PLIANT_GL_OK) return result;
    const char* version = (const char*)GL(gl, GetString)(GL_VERSION);
    if (!version) {
        pliant_gl_say(gl, "no context is current", NULL);
        return PLIANT_GL_ERROR_CONTEXT;
    }
    parse_version(gl, version);
    result = choose_path(gl, wished);
    if (result != PLIANT_GL_OK) return result;
    const uint32_t end
        = gl->path == PLIANT_GL_PATH_COMPUTE ? PLIANT_GL_INDEX_COUNT : (uint32_t)PLIANT_GL_INDEX_DispatchCompute;
    return load_functions(gl, load, 0, end);
}

/* Rows of layers: a power of two of at least 1024, which every context has, and smaller only if asked for. */
static void read_limits(pliant_gl* gl, const pliant_gl_desc* desc)
{
    gl_int size = 0, layers = 0;
    GL(gl, GetIntegerv)(GL_MAX_TEXTURE_SIZE, &size);
    GL(gl, GetIntegerv)(GL_MAX_ARRAY_TEXTURE_LAYERS, &layers);
    if (desc->max_texture_size && desc->max_texture_size < (uint32_t)size) size = (gl_int)desc->max_texture_size;
    if (desc->max_layers && desc->max_layers < (uint32_t)layers) layers = (gl_int)desc->max_layers;
    while (gl->layer_shift < 20 && (2 << gl->layer_shift) <= size) ++gl->layer_shift;
    gl->max_layers = (uint32_t)layers;
}

static int is_good_desc(const pliant_gl_desc* desc)
{
    const uint32_t size = desc->max_texture_size;
    return desc->struct_size == sizeof *desc && (uint32_t)desc->path <= PLIANT_GL_PATH_COMPUTE
        && (size == 0 || (size >= 16 && (size & (size - 1)) == 0));
}

pliant_gl_result pliant_gl_init(pliant_gl* out, pliant_gl_loader load, const pliant_gl_desc* desc)
{
    const pliant_gl_desc usual = pliant_gl_desc_default();
    pliant_gl_state state;
    if (!out) return PLIANT_GL_ERROR_ARGUMENT;
    memset(out, 0, sizeof *out);
    if (!desc) desc = &usual;
    if (!load || !is_good_desc(desc)) return PLIANT_GL_ERROR_ARGUMENT;
    pliant_gl_result result = load_context(out, load, desc->path);
    if (result == PLIANT_GL_OK) {
        read_limits(out, desc);
        pliant_gl_save(out, &state);
        pliant_gl_clear_errors(out);
        result = pliant_gl_make_programs(out);
        if (result == PLIANT_GL_OK) GL(out, GenVertexArrays)(1, &out->vertex_array);
        pliant_gl_restore(out, &state);
    }
    if (result != PLIANT_GL_OK) {
        char message[PLIANT_GL_MESSAGE_SIZE];
        memcpy(message, out->message, sizeof message);
        memset(out, 0, sizeof *out);
        memcpy(out->message, message, sizeof message);
        return result;
    }
    out->magic = PLIANT_GL_MAGIC;
    return PLIANT_GL_OK;
}

void pliant_gl_free(pliant_gl* gl)
{
    if (!gl || gl->magic != PLIANT_GL_MAGIC) return;
    pliant_gl_delete_programs(gl);
    GL(gl, DeleteVertexArrays)(1, &gl->vertex_array);
    gl->magic = 0;
}

/* ------------------------------------------------------------------------------------------------------- instances ---- */

pliant_gl_result pliant_gl_instance_init(pliant_gl_instance* out, const pliant_gl_mesh* mesh)
{
    if (!out) return PLIANT_GL_ERROR_ARGUMENT;
    memset(out, 0, sizeof *out);
    if (!mesh || mesh->magic != PLIANT_GL_MESH_MAGIC) return PLIANT_GL_ERROR_ARGUMENT;
    pliant_gl* gl = mesh->gl;
    gl_name buffers[2] = { 0, 0 };
    const gl_int count = mesh->has_normals ? 2 : 1;
    gl_int bound;
    pliant_gl_clear_errors(gl);
    GL(gl, GetIntegerv)(GL_COPY_WRITE_BUFFER, &bound);
    GL(gl, GenBuffers)(count, buffers);
    for (gl_int i = 0; i < count; ++i) {
        GL(gl, BindBuffer)(GL_COPY_WRITE_BUFFER, buffers[i]);
        GL(gl, BufferData)(GL_COPY_WRITE_BUFFER, (gl_size)mesh->vertex_count * 12, NULL, GL_DYNAMIC_COPY);
    }
    GL(gl, BindBuffer)(GL_COPY_WRITE_BUFFER, (gl_name)bound);
    const pliant_gl_result result = pliant_gl_check_errors(gl);
    if (result != PLIANT_GL_OK) {
        GL(gl, DeleteBuffers)(count, buffers);
        return result;
    }
    out->position_buffer = buffers[0];
    out->normal_buffer = buffers[1];
    out->mesh = mesh;
    out->magic = PLIANT_GL_INSTANCE_MAGIC;
    return PLIANT_GL_OK;
}

void pliant_gl_instance_free(pliant_gl_instance* instance)
{
    if (!instance || instance->magic != PLIANT_GL_INSTANCE_MAGIC) return;
    const gl_name buffers[2] = { instance->position_buffer, instance->normal_buffer };
    GL(instance->mesh->gl, DeleteBuffers)(2, buffers);
    memset(instance, 0, sizeof *instance);
}

static void bind_texture(const pliant_gl* gl, uint32_t unit, gl_name texture)
{
    GL(gl, ActiveTexture)(GL_TEXTURE0 + unit);
    GL(gl, BindTexture)(GL_TEXTURE_2D_ARRAY, texture);
}

/* Runs the program in use `count` times, its output going to `buffer`. */
static void run_feedback(const pliant_gl* gl, uint32_t count, gl_name buffer)
{
    GL(gl, BindBufferBase)(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer);
    GL(gl, BeginTransformFeedback)(GL_POINTS);
    GL(gl, DrawArrays)(GL_POINTS, 0, (gl_int)count);
    GL(gl, EndTransformFeedback)();
    GL(gl, BindBufferBase)(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
}

static void run_compute(const pliant_gl* gl, uint32_t count, gl_int count_location)
{
    const uint32_t groups = (count + PLIANT_GL_GROUP - 1) / PLIANT_GL_GROUP;
    const uint32_t width = groups < 32768u ? groups : 32768u; /* 65,535 is all that is promised */
    GL(gl, Uniform1ui)(count_location, count);
    GL(gl, DispatchCompute)(width, (groups + width - 1) / width, 1);
    GL(gl, MemoryBarrier)(GL_ALL_BARRIER_BITS);
}

/* The same on the path of `gl`. */
static void run(const pliant_gl* gl, uint32_t count, gl_name buffer, gl_int count_location)
{
    if (gl->path == PLIANT_GL_PATH_COMPUTE) {
        GL(gl, BindBufferBase)(GL_SHADER_STORAGE_BUFFER, 0, buffer);
        run_compute(gl, count, count_location);
    } else {
        run_feedback(gl, count, buffer);
    }
}

/* Transform feedback takes points from no attributes and rasterises nothing. */
static void begin_passes(const pliant_gl* gl)
{
    if (gl->path != PLIANT_GL_PATH_FEEDBACK) return;
    GL(gl, BindVertexArray)(gl->vertex_array);
    GL(gl, Enable)(GL_RASTERIZER_DISCARD);
}

void pliant_gl_update_rows(const pliant_gl_mesh* mesh, const float* q, uint32_t columns)
{
    const pliant_gl* gl = mesh->gl;
    begin_passes(gl);
    GL(gl, UseProgram)(gl->row_program);
    bind_texture(gl, PLIANT_GL_UNIT_SHAPE, mesh->shape_texture);
    pliant_gl_set_shape(mesh, &gl->row_locations, PLIANT_GL_UNIT_SHAPE, PLIANT_GL_UNIT_SHAPE, q, columns);
    run(gl, mesh->row_count, mesh->row_buffer, gl->row_count);
    bind_texture(gl, PLIANT_GL_UNIT_ROWS, mesh->row_texture);
    GL(gl, BindBuffer)(GL_PIXEL_UNPACK_BUFFER, mesh->row_buffer);
    pliant_gl_put_rows(mesh);
    GL(gl, BindBuffer)(GL_PIXEL_UNPACK_BUFFER, 0);
}

static void update_positions(const pliant_gl_instance* instance, const float* q, uint32_t columns)
{
    const pliant_gl_mesh* mesh = instance->mesh;
    const pliant_gl* gl = mesh->gl;
    if (mesh->row_count) pliant_gl_update_rows(mesh, q, columns);
    begin_passes(gl);
    GL(gl, UseProgram)(gl->position_program);
    bind_texture(gl, PLIANT_GL_UNIT_SHAPE, mesh->shape_texture);
    pliant_gl_set_shape(mesh, &gl->locations, PLIANT_GL_UNIT_SHAPE,
                        mesh->row_count ? PLIANT_GL_UNIT_ROWS : PLIANT_GL_UNIT_SHAPE, q, columns);
    run(gl, mesh->vertex_count, instance->position_buffer, gl->position_count);
}

/* Under transform feedback normals gather positions from a texture, filled from the buffer without leaving the device. */
static void update_normals(const pliant_gl_instance* instance)
{
    const pliant_gl_mesh* mesh = instance->mesh;
    const pliant_gl* gl = mesh->gl;
    GL(gl, UseProgram)(gl->normal_program);
    GL(gl, Uniform3uiv)(gl->normal_store, 1, mesh->topology_store);
    bind_texture(gl, PLIANT_GL_UNIT_SHAPE, mesh->topology_texture);
    if (gl->path == PLIANT_GL_PATH_COMPUTE) {
        GL(gl, BindBufferBase)(GL_SHADER_STORAGE_BUFFER, 0, instance->position_buffer);
        GL(gl, BindBufferBase)(GL_SHADER_STORAGE_BUFFER, 1, instance->normal_buffer);
        run_compute(gl, mesh->vertex_count, gl->normal_count);
    } else {
        GL(gl, Uniform3uiv)(gl->normal_points, 1, mesh->position_store);
        bind_texture(gl, PLIANT_GL_UNIT_POSITIONS, mesh->position_texture);
        GL(gl, BindBuffer)(GL_PIXEL_UNPACK_BUFFER, instance->position_buffer);
        pliant_gl_put_positions(mesh);
        GL(gl, BindBuffer)(GL_PIXEL_UNPACK_BUFFER, 0);
        run_feedback(gl, mesh->vertex_count, instance->normal_buffer);
    }
}

pliant_gl_result pliant_gl_update_columns(pliant_gl_instance* instance, const float* q, uint32_t columns)
{
    pliant_gl_state state;
    if (!instance || instance->magic != PLIANT_GL_INSTANCE_MAGIC || !q) return PLIANT_GL_ERROR_ARGUMENT;
    const pliant_gl* gl = instance->mesh->gl;
    pliant_gl_save(gl, &state);
    update_positions(instance, q, columns);
    if (instance->mesh->has_normals) update_normals(instance);
    pliant_gl_restore(gl, &state);
    return PLIANT_GL_OK;
}

pliant_gl_result pliant_gl_update(pliant_gl_instance* instance, const float* q)
{
    return pliant_gl_update_columns(instance, q, PLIANT_FORMAT_MAX_DIMENSION);
}

static void point_attribute(const pliant_gl* gl, gl_name buffer, int32_t location)
{
    if (location < 0 || buffer == 0) return;
    GL(gl, BindBuffer)(GL_ARRAY_BUFFER, buffer);
    GL(gl, VertexAttribPointer)((gl_name)location, 3, GL_FLOAT, 0, 12, NULL);
    GL(gl, EnableVertexAttribArray)((gl_name)location);
}

pliant_gl_result pliant_gl_bind_attributes(const pliant_gl_instance* instance, int32_t position, int32_t normal)
{
    if (!instance || instance->magic != PLIANT_GL_INSTANCE_MAGIC) return PLIANT_GL_ERROR_ARGUMENT;
    if (normal >= 0 && !instance->mesh->has_normals) return PLIANT_GL_ERROR_ARGUMENT;
    const pliant_gl* gl = instance->mesh->gl;
    point_attribute(gl, instance->position_buffer, position);
    point_attribute(gl, instance->normal_buffer, normal);
    GL(gl, BindBuffer)(GL_ARRAY_BUFFER, 0);
    GL(gl, BindBuffer)(GL_ELEMENT_ARRAY_BUFFER, instance->mesh->index_buffer);
    return PLIANT_GL_OK;
}

pliant_gl_result pliant_gl_direct_bind(const pliant_gl_mesh* mesh, const pliant_gl_locations* locations, uint32_t unit,
                                       const float* q, uint32_t columns)
{
    if (!mesh || mesh->magic != PLIANT_GL_MESH_MAGIC || !locations || !q) return PLIANT_GL_ERROR_ARGUMENT;
    const pliant_gl* gl = mesh->gl;
    const uint32_t row_unit = mesh->row_count ? unit + 1 : unit; /* samplers of one kind may share a unit */
    gl_int active;
    if (mesh->row_count) {
        pliant_gl_state state;
        pliant_gl_save(gl, &state);
        pliant_gl_update_rows(mesh, q, columns);
        pliant_gl_restore(gl, &state);
    }
    GL(gl, GetIntegerv)(GL_ACTIVE_TEXTURE, &active);
    for (uint32_t i = unit; i <= row_unit; ++i) {
        GL(gl, ActiveTexture)(GL_TEXTURE0 + i);
        GL(gl, BindTexture)(GL_TEXTURE_2D_ARRAY, i == unit ? mesh->shape_texture : mesh->row_texture);
        GL(gl, BindSampler)(i, 0);
    }
    GL(gl, ActiveTexture)((gl_enum)active);
    pliant_gl_set_shape(mesh, locations, unit, row_unit, q, columns);
    return PLIANT_GL_OK;
}
