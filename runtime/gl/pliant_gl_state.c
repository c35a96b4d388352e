/* GL state that the library changes, taken down before and put back after, and GL's error flag. Asking GL costs little:
   drivers answer these from the application's side. */
#include "pliant_gl_internal.h"

static const gl_enum unpack_names[PLIANT_GL_UNPACK_COUNT]
    = { GL_UNPACK_ROW_LENGTH,   GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_IMAGES,
        GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_ALIGNMENT, GL_UNPACK_SWAP_BYTES };

/* OpenGL ES has no GL_UNPACK_SWAP_BYTES, the last one. */
static int unpack_count(const pliant_gl* gl) { return gl->is_es ? PLIANT_GL_UNPACK_COUNT - 1 : PLIANT_GL_UNPACK_COUNT; }

static gl_int get(const pliant_gl* gl, gl_enum name)
{
    gl_int value = 0;
    GL(gl, GetIntegerv)(name, &value);
    return value;
}

/* What the path writes through: names of one indexed buffer binding. */
typedef struct indexed_names {
    gl_enum target, binding, start, size;
    gl_name count;
} indexed_names;

static indexed_names names_of(const pliant_gl* gl)
{
    static const indexed_names feedback = { GL_TRANSFORM_FEEDBACK_BUFFER, GL_TRANSFORM_FEEDBACK_BUFFER_BINDING,
                                            GL_TRANSFORM_FEEDBACK_BUFFER_START, GL_TRANSFORM_FEEDBACK_BUFFER_SIZE, 1 };
    static const indexed_names storage = { GL_SHADER_STORAGE_BUFFER, GL_SHADER_STORAGE_BUFFER_BINDING,
                                           GL_SHADER_STORAGE_BUFFER_START, GL_SHADER_STORAGE_BUFFER_SIZE, 2 };
    return gl->path == PLIANT_GL_PATH_COMPUTE ? storage : feedback;
}

static void save_buffers(const pliant_gl* gl, pliant_gl_state* state)
{
    const indexed_names names = names_of(gl);
    state->unpack_buffer = get(gl, GL_PIXEL_UNPACK_BUFFER_BINDING);
    state->copy_buffer = get(gl, GL_COPY_WRITE_BUFFER);
    state->generic = get(gl, names.binding);
    for (gl_name i = 0; i < names.count; ++i) {
        pliant_gl_binding* binding = &state->indexed[i];
        GL(gl, GetIntegeri_v)(names.binding, i, &binding->buffer);
        GL(gl, GetInteger64i_v)(names.start, i, &binding->start);
        GL(gl, GetInteger64i_v)(names.size, i, &binding->size);
    }
}

static void restore_buffers(const pliant_gl* gl, const pliant_gl_state* state)
{
    const indexed_names names = names_of(gl);
    for (gl_name i = 0; i < names.count; ++i) {
        const pliant_gl_binding* binding = &state->indexed[i];
        if (binding->buffer && binding->size) /* a size of 0: the whole buffer was bound */
            GL(gl, BindBufferRange)
        (names.target, i, (gl_name)binding->buffer, (gl_size)binding->start, (gl_size)binding->size);
        else GL(gl, BindBufferBase)(names.target, i, (gl_name)binding->buffer);
    }
    GL(gl, BindBuffer)(names.target, (gl_name)state->generic);
    GL(gl, BindBuffer)(GL_COPY_WRITE_BUFFER, (gl_name)state->copy_buffer);
    GL(gl, BindBuffer)(GL_PIXEL_UNPACK_BUFFER, (gl_name)state->unpack_buffer);
}

void pliant_gl_save(const pliant_gl* gl, pliant_gl_state* state)
{
    state->program = get(gl, GL_CURRENT_PROGRAM);
    state->vertex_array = get(gl, GL_VERTEX_ARRAY_BINDING);
    state->active_unit = get(gl, GL_ACTIVE_TEXTURE);
    for (gl_name i = 0; i < PLIANT_GL_UNIT_COUNT; ++i) {
        GL(gl, ActiveTexture)(GL_TEXTURE0 + i);
        state->textures[i] = get(gl, GL_TEXTURE_BINDING_2D_ARRAY);
        state->samplers[i] = get(gl, GL_SAMPLER_BINDING);
        GL(gl, BindSampler)(i, 0); /* one that filters would read zeros from integers */
    }
    for (int i = 0; i < unpack_count(gl); ++i) {
        state->unpack[i] = get(gl, unpack_names[i]);
        GL(gl, PixelStorei)(unpack_names[i], unpack_names[i] == GL_UNPACK_ALIGNMENT ? 4 : 0);
    }
    state->discards = GL(gl, IsEnabled)(GL_RASTERIZER_DISCARD) != 0;
    save_buffers(gl, state);
    GL(gl, BindBuffer)(GL_PIXEL_UNPACK_BUFFER, 0);
}

void pliant_gl_restore(const pliant_gl* gl, const pliant_gl_state* state)
{
    restore_buffers(gl, state);
    if (!state->discards) GL(gl, Disable)(GL_RASTERIZER_DISCARD);
    for (int i = 0; i < unpack_count(gl); ++i) GL(gl, PixelStorei)(unpack_names[i], state->unpack[i]);
    for (gl_name i = 0; i < PLIANT_GL_UNIT_COUNT; ++i) {
        GL(gl, ActiveTexture)(GL_TEXTURE0 + i);
        GL(gl, BindTexture)(GL_TEXTURE_2D_ARRAY, (gl_name)state->textures[i]);
        GL(gl, BindSampler)(i, (gl_name)state->samplers[i]);
    }
    GL(gl, ActiveTexture)((gl_enum)state->active_unit);
    GL(gl, BindVertexArray)((gl_name)state->vertex_array);
    GL(gl, UseProgram)((gl_name)state->program);
}

/* ---------------------------------------------------------------------------------------------------------- errors ---- */

/* The bound is for contexts that are lost and report errors for ever. */
void pliant_gl_clear_errors(const pliant_gl* gl)
{
    for (int i = 0; i < 64 && GL(gl, GetError)() != GL_NO_ERROR; ++i) {}
}

pliant_gl_result pliant_gl_check_errors(pliant_gl* gl)
{
    if (GL(gl, GetError)() == GL_NO_ERROR) return PLIANT_GL_OK;
    pliant_gl_say(gl, "the driver reports an error while textures or buffers are made", NULL);
    return PLIANT_GL_ERROR_MEMORY;
}
