/* pliant_gl: contexts, meshes, instances. Shaders are in pliant_gl_shaders.c, what is put back after each call in
   pliant_gl_state.c. */
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

/* With so many layers of 1024 rows the number of a word still fits into 32 bits. */
#define LAYER_LIMIT 2048u

/* Rows of layers: a power of two, as every context has at least 1024, and smaller only if asked for. */
static void read_limits(pliant_gl* gl, const pliant_gl_desc* desc)
{
    gl_int size = 0, layers = 0;
    GL(gl, GetIntegerv)(GL_MAX_TEXTURE_SIZE, &size);
    GL(gl, GetIntegerv)(GL_MAX_ARRAY_TEXTURE_LAYERS, &layers);
    if (desc->max_texture_size && desc->max_texture_size < (uint32_t)size) size = (gl_int)desc->max_texture_size;
    if (desc->max_layers && desc->max_layers < (uint32_t)layers) layers = (gl_int)desc->max_layers;
    while (gl->layer_shift < PLIANT_GL_ROW_SHIFT && (2 << gl->layer_shift) <= size) ++gl->layer_shift;
    gl->max_layers = (uint32_t)layers < LAYER_LIMIT ? (uint32_t)layers : LAYER_LIMIT;
}

/* Errors of before are the caller's; the bound is for contexts that are lost and report errors for ever. */
static void clear_errors(const pliant_gl* gl)
{
    for (int i = 0; i < 64 && GL(gl, GetError)() != GL_NO_ERROR; ++i) {}
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
        clear_errors(out);
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
    GL(gl, DeleteProgram)(gl->position_program);
    GL(gl, DeleteProgram)(gl->normal_program);
    GL(gl, DeleteVertexArrays)(1, &gl->vertex_array);
    gl->magic = 0;
}

/* -------------------------------------------------------------------------------------------------- array textures ---- */

static uint64_t rows_of(uint64_t texels) { return (texels + PLIANT_GL_ROW - 1) / PLIANT_GL_ROW; }

/* What the texels of a texture are. */
typedef struct texel_kind {
    gl_int internal;
    gl_enum format, type;
    uint32_t size;
} texel_kind;

static const texel_kind word_kind = { GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 4 };
static const texel_kind point_kind = { GL_RGB32F, GL_RGB, GL_FLOAT, 12 };

/* A texture of so many rows, bound to the active unit; 0 if the context has none so large. Adds its bytes to *bytes. */
static gl_name make_texture(const pliant_gl* gl, const texel_kind* kind, uint64_t rows, uint64_t* bytes)
{
    const uint64_t layer_rows = (uint64_t)1 << gl->layer_shift, layers = (rows + layer_rows - 1) >> gl->layer_shift;
    const uint64_t height = layers == 1 ? rows : layer_rows;
    gl_name texture = 0;
    if (layers == 0 || layers > gl->max_layers) return 0;
    GL(gl, GenTextures)(1, &texture);
    GL(gl, BindTexture)(GL_TEXTURE_2D_ARRAY, texture);
    GL(gl, TexImage3D)
    (GL_TEXTURE_2D_ARRAY, 0, kind->internal, (gl_int)PLIANT_GL_ROW, (gl_int)height, (gl_int)layers, 0, kind->format,
     kind->type, NULL);
    GL(gl, TexParameteri)(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    GL(gl, TexParameteri)(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    GL(gl, TexParameteri)(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAX_LEVEL, 0);
    *bytes += PLIANT_GL_ROW * height * layers * kind->size;
    return texture;
}

/* Puts `texels` texels into the bound texture, from row `row` on: from memory, or from an offset into the unpack buffer. */
static void put_texels(const pliant_gl* gl, const texel_kind* kind, uint64_t row, uintptr_t from, uint64_t texels)
{
    const uint64_t layer_rows = (uint64_t)1 << gl->layer_shift;
    while (texels > 0) {
        const uint64_t y = row & (layer_rows - 1), left = texels / PLIANT_GL_ROW;
        uint64_t rows = left < layer_rows - y ? left : layer_rows - y, width = PLIANT_GL_ROW;
        if (rows == 0) {
            rows = 1;
            width = texels; /* what does not fill a row */
        }
        GL(gl, TexSubImage3D)
        (GL_TEXTURE_2D_ARRAY, 0, 0, (gl_int)y, (gl_int)(row >> gl->layer_shift), (gl_int)width, (gl_int)rows, 1,
         kind->format, kind->type, (const void*)from);
        row += rows;
        texels -= rows * width;
        from += (uintptr_t)(rows * width * kind->size);
    }
}

/* ------------------------------------------------------------------------------------------------------------ mesh ---- */

/* A run of words that goes into a texture, from the start of a row on. */
typedef struct word_run {
    const void* words;
    uint64_t count;
} word_run;

static uint64_t rows_of_runs(const word_run* runs, size_t count)
{
    uint64_t rows = 0;
    for (size_t i = 0; i < count; ++i) rows += rows_of(runs[i].count);
    return rows;
}

static void put_runs(const pliant_gl* gl, const word_run* runs, size_t count)
{
    uint64_t row = 0;
    for (size_t i = 0; i < count; ++i) {
        put_texels(gl, &word_kind, row, (uintptr_t)runs[i].words, runs[i].count);
        row += rows_of(runs[i].count);
    }
}

/* Where the fields of tile `tile` of a compact basis end, in words; the last one may have fewer than four parts. */
static uint64_t compact_end(const pliant_asset* asset, uint64_t tile, uint64_t rest_tiles)
{
    const uint64_t first = tile * PLIANT_FORMAT_COMPACT_PARTS, left = rest_tiles - first;
    const uint64_t parts = left < PLIANT_FORMAT_COMPACT_PARTS ? left : PLIANT_FORMAT_COMPACT_PARTS;
    uint32_t bits = 0;
    for (uint32_t j = 0; j < asset->dimension; ++j) bits += asset->fields[tile * asset->dimension + j].width;
    return asset->tiles[tile].offset + parts * pliant_format_compact_part(bits);
}

/* A compact basis as the file has it: tiles, fields, data. Fills the runs behind the first. */
static size_t compact_runs(pliant_gl_mesh* mesh, const pliant_asset* asset, uint64_t used_tiles, word_run* runs)
{
    const uint64_t rest_tiles
        = ((uint64_t)asset->vertex_count + PLIANT_FORMAT_TILE_VERTICES - 1) / PLIANT_FORMAT_TILE_VERTICES;
    const uint64_t tiles = (rest_tiles + PLIANT_FORMAT_COMPACT_PARTS - 1) / PLIANT_FORMAT_COMPACT_PARTS;
    const uint64_t used = (used_tiles + PLIANT_FORMAT_COMPACT_PARTS - 1) / PLIANT_FORMAT_COMPACT_PARTS;
    runs[1].words = asset->tiles;
    runs[1].count = 2 * tiles;
    runs[2].words = asset->fields;
    runs[2].count = 2 * tiles * asset->dimension;
    runs[3].words = asset->data;
    runs[3].count = compact_end(asset, used - 1, rest_tiles);
    mesh->compact[0] = (uint32_t)(rows_of_runs(runs, 2) << PLIANT_GL_ROW_SHIFT);
    mesh->compact[1] = (uint32_t)(rows_of_runs(runs, 3) << PLIANT_GL_ROW_SHIFT);
    mesh->compact[2] = (uint32_t)compact_end(asset, tiles - 1, rest_tiles);
    mesh->compact[3] = (uint32_t)rest_tiles;
    for (uint32_t j = 0; j < asset->dimension; ++j) {
        mesh->scales[j] = asset->columns[j].scale;
        mesh->steps[j] = (float)(1u << asset->columns[j].shift);
    }
    return 4;
}

/* REST and the basis as the file has them. Tiles past the boundary of a solid are left out: they come last. */
static pliant_gl_result upload_shape(pliant_gl_mesh* mesh, const pliant_asset* asset)
{
    const pliant_gl* gl = mesh->gl;
    const uint64_t tiles = ((uint64_t)mesh->vertex_count + PLIANT_FORMAT_TILE_VERTICES - 1) / PLIANT_FORMAT_TILE_VERTICES;
    word_run runs[4] = { { asset->rest, tiles * PLIANT_FORMAT_TILE_FLOATS }, { NULL, 0 }, { NULL, 0 }, { NULL, 0 } };
    size_t count = 2;
    if (asset->columns) {
        count = compact_runs(mesh, asset, tiles, runs);
    } else {
        runs[1].words = asset->basis;
        runs[1].count = runs[0].count * asset->dimension;
        for (uint32_t j = 0; j < asset->dimension; ++j) mesh->scales[j] = 1.0f;
    }
    mesh->store[2] = (uint32_t)(rows_of(runs[0].count) << PLIANT_GL_ROW_SHIFT);
    mesh->shape_texture = make_texture(gl, &word_kind, rows_of_runs(runs, count), &mesh->byte_count);
    if (!mesh->shape_texture) return PLIANT_GL_ERROR_LIMIT;
    put_runs(gl, runs, count);
    return PLIANT_GL_OK;
}

/* Start and count of every vertex's words, some rows at a time, then the words. */
static pliant_gl_result upload_topology(pliant_gl_mesh* mesh, const pliant_normals* normals)
{
    const pliant_gl* gl = mesh->gl;
    const uint64_t spans = rows_of(2 * (uint64_t)mesh->vertex_count);
    uint32_t row[PLIANT_GL_ROW];
    mesh->topology_start = (uint32_t)(spans << PLIANT_GL_ROW_SHIFT);
    mesh->topology_texture
        = make_texture(gl, &word_kind, spans + rows_of((uint64_t)normals->neighbour_count), &mesh->byte_count);
    if (!mesh->topology_texture) return PLIANT_GL_ERROR_LIMIT;
    for (uint32_t v = 0; v < mesh->vertex_count;) {
        const uint64_t at = 2 * (uint64_t)v / PLIANT_GL_ROW;
        uint32_t count = 0;
        for (; count < PLIANT_GL_ROW && v < mesh->vertex_count; ++v) {
            const size_t group = normals->groups ? normals->groups[v] : v;
            row[count++] = normals->starts[group];
            row[count++] = normals->starts[group + 1] - normals->starts[group];
        }
        put_texels(gl, &word_kind, at, (uintptr_t)row, count);
    }
    put_texels(gl, &word_kind, spans, (uintptr_t)normals->neighbours, normals->neighbour_count);
    if (gl->path == PLIANT_GL_PATH_COMPUTE) return PLIANT_GL_OK; /* reads positions where they are */
    mesh->position_texture = make_texture(gl, &point_kind, rows_of(mesh->vertex_count), &mesh->byte_count);
    return mesh->position_texture ? PLIANT_GL_OK : PLIANT_GL_ERROR_LIMIT;
}

static void upload_indices(pliant_gl_mesh* mesh, const pliant_asset* asset)
{
    const pliant_gl* gl = mesh->gl;
    const uint64_t size = 12 * (uint64_t)asset->triangle_count;
    GL(gl, GenBuffers)(1, &mesh->index_buffer);
    GL(gl, BindBuffer)(GL_COPY_WRITE_BUFFER, mesh->index_buffer);
    GL(gl, BufferData)(GL_COPY_WRITE_BUFFER, (gl_size)size, asset->triangles, GL_STATIC_DRAW);
    mesh->byte_count += size;
}

static void delete_mesh(pliant_gl_mesh* mesh)
{
    const gl_name textures[3] = { mesh->shape_texture, mesh->topology_texture, mesh->position_texture };
    GL(mesh->gl, DeleteTextures)(3, textures); /* zeros are skipped */
    GL(mesh->gl, DeleteBuffers)(1, &mesh->index_buffer);
    memset(mesh, 0, sizeof *mesh);
}

static pliant_gl_result check_errors(pliant_gl* gl)
{
    if (GL(gl, GetError)() == GL_NO_ERROR) return PLIANT_GL_OK;
    pliant_gl_say(gl, "the driver reports an error while textures or buffers are made", NULL);
    return PLIANT_GL_ERROR_MEMORY;
}

pliant_gl_result pliant_gl_mesh_init(pliant_gl_mesh* out, pliant_gl* gl, const pliant_asset* asset,
                                     const pliant_normals* normals)
{
    pliant_gl_state state;
    if (!out) return PLIANT_GL_ERROR_ARGUMENT;
    memset(out, 0, sizeof *out);
    if (!gl || gl->magic != PLIANT_GL_MAGIC || !asset || !asset->rest || (!asset->basis && !asset->columns))
        return PLIANT_GL_ERROR_ARGUMENT;
    if (normals && (!normals->starts || normals->vertex_count != asset->boundary_vertex_count))
        return PLIANT_GL_ERROR_ARGUMENT;

    out->gl = gl;
    out->vertex_count = asset->boundary_vertex_count;
    out->index_count = 3 * asset->triangle_count;
    out->has_normals = normals != NULL;
    out->dimension = asset->dimension;
    out->store[0] = (1u << gl->layer_shift) - 1u;
    out->store[1] = gl->layer_shift + PLIANT_GL_ROW_SHIFT;
    memcpy(out->origin, asset->origin, sizeof out->origin);
    pliant_gl_save(gl, &state);
    clear_errors(gl);
    pliant_gl_result result = upload_shape(out, asset);
    if (result == PLIANT_GL_OK && normals) result = upload_topology(out, normals);
    if (result == PLIANT_GL_OK) upload_indices(out, asset);
    if (result == PLIANT_GL_OK) result = check_errors(gl);
    pliant_gl_restore(gl, &state);
    if (result != PLIANT_GL_OK) {
        delete_mesh(out);
        return result;
    }
    out->magic = PLIANT_GL_MESH_MAGIC;
    return PLIANT_GL_OK;
}

void pliant_gl_mesh_free(pliant_gl_mesh* mesh)
{
    if (mesh && mesh->magic == PLIANT_GL_MESH_MAGIC) delete_mesh(mesh);
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
    clear_errors(gl);
    GL(gl, GetIntegerv)(GL_COPY_WRITE_BUFFER, &bound);
    GL(gl, GenBuffers)(count, buffers);
    for (gl_int i = 0; i < count; ++i) {
        GL(gl, BindBuffer)(GL_COPY_WRITE_BUFFER, buffers[i]);
        GL(gl, BufferData)(GL_COPY_WRITE_BUFFER, (gl_size)mesh->vertex_count * 12, NULL, GL_DYNAMIC_COPY);
    }
    GL(gl, BindBuffer)(GL_COPY_WRITE_BUFFER, (gl_name)bound);
    const pliant_gl_result result = check_errors(gl);
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

/* Runs the program in use once for every vertex, its output going to `buffer`. */
static void run_feedback(const pliant_gl_mesh* mesh, gl_name buffer)
{
    const pliant_gl* gl = mesh->gl;
    GL(gl, BindBufferBase)(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer);
    GL(gl, BeginTransformFeedback)(GL_POINTS);
    GL(gl, DrawArrays)(GL_POINTS, 0, (gl_int)mesh->vertex_count);
    GL(gl, EndTransformFeedback)();
    GL(gl, BindBufferBase)(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
}

static void run_compute(const pliant_gl_mesh* mesh, gl_int count_location)
{
    const uint32_t groups = (mesh->vertex_count + PLIANT_GL_GROUP - 1) / PLIANT_GL_GROUP;
    const uint32_t width = groups < 32768u ? groups : 32768u; /* 65,535 is all that is promised */
    GL(mesh->gl, Uniform1ui)(count_location, mesh->vertex_count);
    GL(mesh->gl, DispatchCompute)(width, (groups + width - 1) / width, 1);
    GL(mesh->gl, MemoryBarrier)(GL_ALL_BARRIER_BITS);
}

static void update_positions(const pliant_gl_instance* instance, const float* q, uint32_t columns)
{
    const pliant_gl_mesh* mesh = instance->mesh;
    const pliant_gl* gl = mesh->gl;
    GL(gl, UseProgram)(gl->position_program);
    bind_texture(gl, PLIANT_GL_UNIT_SHAPE, mesh->shape_texture);
    pliant_gl_set_shape(mesh, &gl->locations, PLIANT_GL_UNIT_SHAPE, q, columns);
    if (gl->path == PLIANT_GL_PATH_COMPUTE) {
        GL(gl, BindBufferBase)(GL_SHADER_STORAGE_BUFFER, 0, instance->position_buffer);
        run_compute(mesh, gl->position_count);
    } else {
        run_feedback(mesh, instance->position_buffer);
    }
}

/* Under transform feedback normals gather positions from a texture, filled from the buffer without leaving the device. */
static void update_normals(const pliant_gl_instance* instance)
{
    const pliant_gl_mesh* mesh = instance->mesh;
    const pliant_gl* gl = mesh->gl;
    const gl_name store[3] = { mesh->store[0], mesh->store[1], mesh->topology_start };
    GL(gl, UseProgram)(gl->normal_program);
    GL(gl, Uniform3uiv)(gl->normal_store, 1, store);
    bind_texture(gl, PLIANT_GL_UNIT_SHAPE, mesh->topology_texture);
    if (gl->path == PLIANT_GL_PATH_COMPUTE) {
        GL(gl, BindBufferBase)(GL_SHADER_STORAGE_BUFFER, 0, instance->position_buffer);
        GL(gl, BindBufferBase)(GL_SHADER_STORAGE_BUFFER, 1, instance->normal_buffer);
        run_compute(mesh, gl->normal_count);
    } else {
        bind_texture(gl, PLIANT_GL_UNIT_POSITIONS, mesh->position_texture);
        GL(gl, BindBuffer)(GL_PIXEL_UNPACK_BUFFER, instance->position_buffer);
        put_texels(gl, &point_kind, 0, 0, mesh->vertex_count);
        GL(gl, BindBuffer)(GL_PIXEL_UNPACK_BUFFER, 0);
        run_feedback(mesh, instance->normal_buffer);
    }
}

pliant_gl_result pliant_gl_update_columns(pliant_gl_instance* instance, const float* q, uint32_t columns)
{
    pliant_gl_state state;
    if (!instance || instance->magic != PLIANT_GL_INSTANCE_MAGIC || !q) return PLIANT_GL_ERROR_ARGUMENT;
    const pliant_gl* gl = instance->mesh->gl;
    pliant_gl_save(gl, &state);
    if (gl->path == PLIANT_GL_PATH_FEEDBACK) {
        GL(gl, BindVertexArray)(gl->vertex_array);
        GL(gl, Enable)(GL_RASTERIZER_DISCARD);
    }
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
