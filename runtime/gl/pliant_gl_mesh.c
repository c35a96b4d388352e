/* An asset on the graphics processor: array textures of words, as the file has them, and the index buffer. */
#include "pliant_gl_internal.h"

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

/* How many rows layers have, as a power of two: one layer if it can be, else the smallest layers that are few enough, as the
   last one is hardly ever full. */
static uint32_t choose_shift(const pliant_gl* gl, uint64_t rows)
{
    uint32_t shift = 0;
    while (shift < gl->layer_shift && ((uint64_t)1 << shift) < rows) ++shift;
    if (((uint64_t)1 << shift) >= rows) return shift;
    shift = PLIANT_GL_ROW_SHIFT < gl->layer_shift ? PLIANT_GL_ROW_SHIFT : gl->layer_shift;
    while (shift < gl->layer_shift && (rows >> shift) >= gl->max_layers) ++shift;
    return shift;
}

/* In so many rows the number of a word still has 32 bits. */
#define ROW_LIMIT (1u << (32u - PLIANT_GL_ROW_SHIFT))

/* A texture of so many rows, bound to the active unit; 0 if the context has none so large. Adds its bytes to *bytes, writes
   mask and shift of its rows to store[0] and store[1]. */
static gl_name make_texture(const pliant_gl* gl, const texel_kind* kind, uint64_t rows, uint32_t* store, uint64_t* bytes)
{
    const uint32_t shift = choose_shift(gl, rows);
    const uint64_t layer_rows = (uint64_t)1 << shift, layers = (rows + layer_rows - 1) >> shift;
    const uint64_t height = layers == 1 ? rows : layer_rows;
    gl_name texture = 0;
    if (rows == 0 || rows > ROW_LIMIT || layers > gl->max_layers) return 0;
    store[0] = (uint32_t)layer_rows - 1u;
    store[1] = shift + PLIANT_GL_ROW_SHIFT;
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

/* Puts `texels` texels into the bound texture of these rows, from row `row` on: from memory, or from an offset into the
   unpack buffer. */
static void put_texels(const pliant_gl* gl, const texel_kind* kind, const uint32_t* store, uint64_t row, uintptr_t from,
                       uint64_t texels)
{
    const uint64_t layer_rows = (uint64_t)store[0] + 1;
    while (texels > 0) {
        const uint64_t y = row & store[0], left = texels / PLIANT_GL_ROW;
        uint64_t rows = left < layer_rows - y ? left : layer_rows - y, width = PLIANT_GL_ROW;
        if (rows == 0) {
            rows = 1;
            width = texels; /* what does not fill a row */
        }
        GL(gl, TexSubImage3D)
        (GL_TEXTURE_2D_ARRAY, 0, 0, (gl_int)y, (gl_int)(row / layer_rows), (gl_int)width, (gl_int)rows, 1, kind->format,
         kind->type, (const void*)from);
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

static void put_runs(const pliant_gl* gl, const uint32_t* store, const word_run* runs, size_t count)
{
    uint64_t row = 0;
    for (size_t i = 0; i < count; ++i) {
        put_texels(gl, &word_kind, store, row, (uintptr_t)runs[i].words, runs[i].count);
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

/* -------------------------------------------------------------------------------------------------- factored bases ---- */

/* Words that are computed while they are put into the shape texture, a row of texels at a time. */
typedef struct row_writer {
    const pliant_gl_mesh* mesh;
    uint64_t row;
    uint32_t words[PLIANT_GL_ROW], count;
} row_writer;

static void flush_row(row_writer* writer)
{
    if (writer->count > 0)
        put_texels(writer->mesh->gl, &word_kind, writer->mesh->store, writer->row++, (uintptr_t)writer->words,
                   writer->count);
    writer->count = 0;
}

static void put_word(row_writer* writer, uint32_t word)
{
    writer->words[writer->count++] = word;
    if (writer->count == PLIANT_GL_ROW) flush_row(writer);
}

/* For vertices first .. first+count-1, at most a row of them: 64 times the tile, plus the place in it. */
static void find_slots(const pliant_asset* asset, uint32_t first, uint32_t count, uint32_t* slots)
{
    const uint32_t size = asset->block_vertices;
    for (uint32_t block = first / size; block * (uint64_t)size < (uint64_t)first + count; ++block)
        for (uint32_t t = asset->blocks[block]; t < asset->blocks[block + 1]; ++t) {
            const uint16_t* vertices = (const uint16_t*)(const void*)(asset->data + asset->products[t].offset);
            for (uint32_t i = 0; i < asset->products[t].vertex_count; ++i) {
                const uint64_t v = block * (uint64_t)size + vertices[i];
                if (v >= first && v - first < count) slots[v - first] = PLIANT_FORMAT_COMPACT_VERTICES * t + i;
            }
        }
}

static void put_slots(row_writer* writer, const pliant_asset* asset)
{
    for (uint32_t v = 0; v < writer->mesh->vertex_count; v += PLIANT_GL_ROW) {
        const uint32_t left = writer->mesh->vertex_count - v;
        writer->count = left < PLIANT_GL_ROW ? left : PLIANT_GL_ROW;
        find_slots(asset, v, writer->count, writer->words);
        flush_row(writer);
    }
}

/* Rows that tile `tile` needs; none inside a solid, which nobody draws: the first of its sorted vertices decides. `block`:
   that of the tile before, becomes its own. */
static uint32_t drawn_rows(const pliant_gl_mesh* mesh, const pliant_asset* asset, uint32_t tile, uint32_t* block)
{
    while (tile >= asset->blocks[*block + 1]) ++*block;
    const uint16_t* vertices = (const uint16_t*)(const void*)(asset->data + asset->products[tile].offset);
    const int is_drawn = *block * (uint64_t)asset->block_vertices + vertices[0] < mesh->vertex_count; /* they are sorted */
    return is_drawn ? pliant_format_product_rows(asset->products + tile) : 0;
}

static void put_row_starts(row_writer* writer, const pliant_asset* asset, uint32_t tile_count)
{
    uint32_t row = 0, block = 0;
    for (uint32_t t = 0; t < tile_count; ++t) {
        put_word(writer, row);
        row += drawn_rows(writer->mesh, asset, t, &block);
    }
    flush_row(writer);
}

/* Where groups of eight rows are computed from; `data_at`: where the data is in the texture. */
static void put_row_groups(row_writer* writer, const pliant_asset* asset, uint32_t tile_count, uint32_t data_at)
{
    uint32_t block = 0;
    for (uint32_t t = 0; t < tile_count; ++t) {
        const pliant_format_product* tile = asset->products + t;
        const uint32_t rows = drawn_rows(writer->mesh, asset, t, &block), stride = rows / 2;
        const uint32_t scales
            = data_at + tile->offset + pliant_format_product_parts(tile) * (PLIANT_FORMAT_TILE_VERTICES / 2);
        for (uint32_t i = 0; i < rows; i += PLIANT_FORMAT_ROW_GROUP) {
            put_word(writer, scales + i);
            put_word(writer, scales + rows + i / 2);
            put_word(writer, stride);
        }
    }
    flush_row(writer);
}

static pliant_gl_result make_rows(pliant_gl_mesh* mesh)
{
    const pliant_gl* gl = mesh->gl;
    const uint64_t size = mesh->row_count * (uint64_t)sizeof(float);
    mesh->row_texture = make_texture(gl, &word_kind, rows_of(mesh->row_count), mesh->rows_store, &mesh->byte_count);
    if (!mesh->row_texture) return PLIANT_GL_ERROR_LIMIT;
    GL(gl, GenBuffers)(1, &mesh->row_buffer);
    GL(gl, BindBuffer)(GL_COPY_WRITE_BUFFER, mesh->row_buffer);
    GL(gl, BufferData)(GL_COPY_WRITE_BUFFER, (gl_size)size, NULL, GL_DYNAMIC_COPY);
    mesh->byte_count += size;
    return PLIANT_GL_OK;
}

void pliant_gl_put_rows(const pliant_gl_mesh* mesh)
{
    put_texels(mesh->gl, &word_kind, mesh->rows_store, 0, 0, mesh->row_count);
}

/* Slots of the vertices, tiles, first rows, groups of rows, data: each from the start of a row of texels on. */
static pliant_gl_result upload_factored(pliant_gl_mesh* mesh, const pliant_asset* asset)
{
    const pliant_gl* gl = mesh->gl;
    const uint32_t blocks = pliant_format_block_count(asset->vertex_count, asset->block_vertices);
    const uint32_t tiles = asset->blocks[blocks];
    uint64_t rows = 0;
    for (uint32_t t = 0, block = 0; t < tiles; ++t) rows += drawn_rows(mesh, asset, t, &block);
    const uint64_t data_words = asset->data_words;
    const word_run runs[5] = { { NULL, mesh->vertex_count },
                               { asset->products, 6 * (uint64_t)tiles },
                               { NULL, tiles },
                               { NULL, 3 * rows / PLIANT_FORMAT_ROW_GROUP },
                               { asset->data, data_words } };
    const uint64_t all = rows_of_runs(runs, 5);
    if (all > ROW_LIMIT || rows > UINT32_MAX) return PLIANT_GL_ERROR_LIMIT;
    mesh->row_count = (uint32_t)rows;
    mesh->store[2] = (uint32_t)(rows_of_runs(runs, 1) << PLIANT_GL_ROW_SHIFT);
    mesh->compact[0] = (uint32_t)(rows_of_runs(runs, 2) << PLIANT_GL_ROW_SHIFT);
    mesh->compact[1] = (uint32_t)(rows_of_runs(runs, 4) << PLIANT_GL_ROW_SHIFT);
    mesh->compact[2] = (uint32_t)data_words;
    mesh->compact[3] = tiles;
    for (uint32_t j = 0; j < asset->dimension; ++j) mesh->scales[j] = asset->columns[j].scale;
    mesh->shape_texture = make_texture(gl, &word_kind, all, mesh->store, &mesh->byte_count);
    if (!mesh->shape_texture) return PLIANT_GL_ERROR_LIMIT;
    row_writer writer = { mesh, 0, { 0 }, 0 };
    put_slots(&writer, asset);
    put_texels(gl, &word_kind, mesh->store, writer.row, (uintptr_t)runs[1].words, runs[1].count);
    writer.row += rows_of(runs[1].count);
    put_row_starts(&writer, asset, tiles);
    put_row_groups(&writer, asset, tiles, mesh->compact[1]);
    put_texels(gl, &word_kind, mesh->store, writer.row, (uintptr_t)runs[4].words, runs[4].count);
    mesh->rows_store[2] = (uint32_t)(rows_of_runs(runs, 3) << PLIANT_GL_ROW_SHIFT);
    return mesh->row_count ? make_rows(mesh) : PLIANT_GL_OK;
}

/* ----------------------------------------------------------------------------------------------------------- upload ---- */

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
    mesh->shape_texture = make_texture(gl, &word_kind, rows_of_runs(runs, count), mesh->store, &mesh->byte_count);
    if (!mesh->shape_texture) return PLIANT_GL_ERROR_LIMIT;
    put_runs(gl, mesh->store, runs, count);
    return PLIANT_GL_OK;
}

/* Start and count of every vertex's words, some rows at a time, then the words. */
static pliant_gl_result upload_topology(pliant_gl_mesh* mesh, const pliant_normals* normals)
{
    const pliant_gl* gl = mesh->gl;
    const uint64_t spans = rows_of(2 * (uint64_t)mesh->vertex_count);
    uint32_t row[PLIANT_GL_ROW];
    mesh->topology_store[2] = (uint32_t)(spans << PLIANT_GL_ROW_SHIFT);
    mesh->topology_texture = make_texture(gl, &word_kind, spans + rows_of((uint64_t)normals->neighbour_count),
                                          mesh->topology_store, &mesh->byte_count);
    if (!mesh->topology_texture) return PLIANT_GL_ERROR_LIMIT;
    for (uint32_t v = 0; v < mesh->vertex_count;) {
        const uint64_t at = 2 * (uint64_t)v / PLIANT_GL_ROW;
        uint32_t count = 0;
        for (; count < PLIANT_GL_ROW && v < mesh->vertex_count; ++v) {
            const size_t group = normals->groups ? normals->groups[v] : v;
            row[count++] = normals->starts[group];
            row[count++] = normals->starts[group + 1] - normals->starts[group];
        }
        put_texels(gl, &word_kind, mesh->topology_store, at, (uintptr_t)row, count);
    }
    put_texels(gl, &word_kind, mesh->topology_store, spans, (uintptr_t)normals->neighbours, normals->neighbour_count);
    if (gl->path == PLIANT_GL_PATH_COMPUTE) return PLIANT_GL_OK; /* reads positions where they are */
    mesh->position_texture
        = make_texture(gl, &point_kind, rows_of(mesh->vertex_count), mesh->position_store, &mesh->byte_count);
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

void pliant_gl_put_positions(const pliant_gl_mesh* mesh)
{
    put_texels(mesh->gl, &point_kind, mesh->position_store, 0, 0, mesh->vertex_count);
}

static void delete_mesh(pliant_gl_mesh* mesh)
{
    const gl_name textures[4] = { mesh->shape_texture, mesh->topology_texture, mesh->position_texture, mesh->row_texture };
    const gl_name buffers[2] = { mesh->index_buffer, mesh->row_buffer };
    GL(mesh->gl, DeleteTextures)(4, textures); /* zeros are skipped */
    GL(mesh->gl, DeleteBuffers)(2, buffers);
    memset(mesh, 0, sizeof *mesh);
}

pliant_gl_result pliant_gl_mesh_init(pliant_gl_mesh* out, pliant_gl* gl, const pliant_asset* asset,
                                     const pliant_normals* normals)
{
    pliant_gl_state state;
    if (!out) return PLIANT_GL_ERROR_ARGUMENT;
    memset(out, 0, sizeof *out);
    if (!gl || gl->magic != PLIANT_GL_MAGIC || !asset || (!asset->basis && !asset->columns)) return PLIANT_GL_ERROR_ARGUMENT;
    if (normals && (!normals->starts || normals->vertex_count != asset->boundary_vertex_count))
        return PLIANT_GL_ERROR_ARGUMENT;

    out->gl = gl;
    out->vertex_count = asset->boundary_vertex_count;
    out->index_count = 3 * asset->triangle_count;
    out->has_normals = normals != NULL;
    out->dimension = asset->dimension;
    memcpy(out->origin, asset->origin, sizeof out->origin);
    pliant_gl_save(gl, &state);
    pliant_gl_clear_errors(gl);
    pliant_gl_result result = asset->products ? upload_factored(out, asset) : upload_shape(out, asset);
    if (result == PLIANT_GL_OK && normals) result = upload_topology(out, normals);
    if (result == PLIANT_GL_OK) upload_indices(out, asset);
    if (result == PLIANT_GL_OK) result = pliant_gl_check_errors(gl);
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
