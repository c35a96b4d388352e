/* What the files of pliant_gl share: the GL types, constants and functions that they use, declared here so that no GL
   headers are needed. Not installed, not part of the API. */
#ifndef PLIANT_GL_INTERNAL_H
#define PLIANT_GL_INTERNAL_H

#include "pliant_gl.h"

#include "pliant_format.h"

#include <string.h>

#if defined(_WIN32) && !defined(_WIN64)
#define PLIANT_GL_CALL __stdcall
#else
#define PLIANT_GL_CALL
#endif

/* Types as GL's registry defines them for every platform. */
typedef unsigned int gl_enum;
typedef unsigned int gl_name;
typedef int gl_int;
typedef ptrdiff_t gl_size;

/* Every function: index and type pliant_gl_fn_NAME. Those from DispatchCompute on are there in compute contexts only. */
/* clang-format off */
#define PLIANT_GL_FUNCTIONS(X)                                                                                              \
    X(const unsigned char*, GetString, (gl_enum))                                                                           \
    X(gl_enum, GetError, (void))                                                                                            \
    X(void, GetIntegerv, (gl_enum, gl_int*))                                                                                \
    X(void, GetIntegeri_v, (gl_enum, gl_name, gl_int*))                                                                     \
    X(void, GetInteger64i_v, (gl_enum, gl_name, int64_t*))                                                                  \
    X(unsigned char, IsEnabled, (gl_enum))                                                                                  \
    X(void, Enable, (gl_enum))                                                                                              \
    X(void, Disable, (gl_enum))                                                                                             \
    X(void, GenTextures, (gl_int, gl_name*))                                                                                \
    X(void, DeleteTextures, (gl_int, const gl_name*))                                                                       \
    X(void, BindTexture, (gl_enum, gl_name))                                                                                \
    X(void, ActiveTexture, (gl_enum))                                                                                       \
    X(void, BindSampler, (gl_name, gl_name))                                                                                \
    X(void, TexImage3D, (gl_enum, gl_int, gl_int, gl_int, gl_int, gl_int, gl_int, gl_enum, gl_enum, const void*))           \
    X(void, TexSubImage3D,                                                                                                  \
      (gl_enum, gl_int, gl_int, gl_int, gl_int, gl_int, gl_int, gl_int, gl_enum, gl_enum, const void*))                     \
    X(void, TexParameteri, (gl_enum, gl_enum, gl_int))                                                                      \
    X(void, PixelStorei, (gl_enum, gl_int))                                                                                 \
    X(void, GenBuffers, (gl_int, gl_name*))                                                                                 \
    X(void, DeleteBuffers, (gl_int, const gl_name*))                                                                        \
    X(void, BindBuffer, (gl_enum, gl_name))                                                                                 \
    X(void, BindBufferBase, (gl_enum, gl_name, gl_name))                                                                    \
    X(void, BindBufferRange, (gl_enum, gl_name, gl_name, gl_size, gl_size))                                                 \
    X(void, BufferData, (gl_enum, gl_size, const void*, gl_enum))                                                           \
    X(void, GenVertexArrays, (gl_int, gl_name*))                                                                            \
    X(void, DeleteVertexArrays, (gl_int, const gl_name*))                                                                   \
    X(void, BindVertexArray, (gl_name))                                                                                     \
    X(void, EnableVertexAttribArray, (gl_name))                                                                             \
    X(void, VertexAttribPointer, (gl_name, gl_int, gl_enum, unsigned char, gl_int, const void*))                            \
    X(gl_name, CreateShader, (gl_enum))                                                                                     \
    X(void, DeleteShader, (gl_name))                                                                                        \
    X(void, ShaderSource, (gl_name, gl_int, const char* const*, const gl_int*))                                             \
    X(void, CompileShader, (gl_name))                                                                                       \
    X(void, GetShaderiv, (gl_name, gl_enum, gl_int*))                                                                       \
    X(void, GetShaderInfoLog, (gl_name, gl_int, gl_int*, char*))                                                            \
    X(gl_name, CreateProgram, (void))                                                                                       \
    X(void, DeleteProgram, (gl_name))                                                                                       \
    X(void, AttachShader, (gl_name, gl_name))                                                                               \
    X(void, LinkProgram, (gl_name))                                                                                         \
    X(void, GetProgramiv, (gl_name, gl_enum, gl_int*))                                                                      \
    X(void, GetProgramInfoLog, (gl_name, gl_int, gl_int*, char*))                                                           \
    X(void, UseProgram, (gl_name))                                                                                          \
    X(void, TransformFeedbackVaryings, (gl_name, gl_int, const char* const*, gl_enum))                                      \
    X(gl_int, GetUniformLocation, (gl_name, const char*))                                                                   \
    X(void, Uniform1i, (gl_int, gl_int))                                                                                    \
    X(void, Uniform1ui, (gl_int, gl_name))                                                                                  \
    X(void, Uniform2ui, (gl_int, gl_name, gl_name))                                                                         \
    X(void, Uniform3fv, (gl_int, gl_int, const float*))                                                                     \
    X(void, Uniform3uiv, (gl_int, gl_int, const gl_name*))                                                                  \
    X(void, Uniform4fv, (gl_int, gl_int, const float*))                                                                     \
    X(void, Uniform4uiv, (gl_int, gl_int, const gl_name*))                                                                  \
    X(void, BeginTransformFeedback, (gl_enum))                                                                              \
    X(void, EndTransformFeedback, (void))                                                                                   \
    X(void, DrawArrays, (gl_enum, gl_int, gl_int))                                                                          \
    X(void, DispatchCompute, (gl_name, gl_name, gl_name))                                                                   \
    X(void, MemoryBarrier, (gl_name))
/* clang-format on */

#define PLIANT_GL_DECLARE(result, name, parameters) typedef result(PLIANT_GL_CALL* pliant_gl_fn_##name) parameters;
PLIANT_GL_FUNCTIONS(PLIANT_GL_DECLARE)
#undef PLIANT_GL_DECLARE

#define PLIANT_GL_INDEX(result, name, parameters) PLIANT_GL_INDEX_##name,
enum { PLIANT_GL_FUNCTIONS(PLIANT_GL_INDEX) PLIANT_GL_INDEX_COUNT };
#undef PLIANT_GL_INDEX

/* The function NAME of a pliant_gl: GL(gl, BindBuffer)(target, buffer). */
#define GL(gl, name) ((pliant_gl_fn_##name)(gl)->functions[PLIANT_GL_INDEX_##name])

enum {
    GL_POINTS = 0x0000,
    GL_NO_ERROR = 0,
    GL_OUT_OF_MEMORY = 0x0505,
    GL_UNSIGNED_INT = 0x1405,
    GL_FLOAT = 0x1406,
    GL_RGB = 0x1907,
    GL_VERSION = 0x1F02,
    GL_NEAREST = 0x2600,
    GL_TEXTURE_MAG_FILTER = 0x2800,
    GL_TEXTURE_MIN_FILTER = 0x2801,
    GL_TEXTURE_MAX_LEVEL = 0x813D,
    GL_MAX_TEXTURE_SIZE = 0x0D33,
    GL_MAX_ARRAY_TEXTURE_LAYERS = 0x88FF,
    GL_TEXTURE0 = 0x84C0,
    GL_ACTIVE_TEXTURE = 0x84E0,
    GL_TEXTURE_2D_ARRAY = 0x8C1A,
    GL_TEXTURE_BINDING_2D_ARRAY = 0x8C1D,
    GL_SAMPLER_BINDING = 0x8919,
    GL_R32UI = 0x8236,
    GL_RED_INTEGER = 0x8D94,
    GL_RGB32F = 0x8815,
    GL_UNPACK_ROW_LENGTH = 0x0CF2,
    GL_UNPACK_SKIP_ROWS = 0x0CF3,
    GL_UNPACK_SKIP_PIXELS = 0x0CF4,
    GL_UNPACK_SWAP_BYTES = 0x0CF0,
    GL_UNPACK_ALIGNMENT = 0x0CF5,
    GL_UNPACK_SKIP_IMAGES = 0x806D,
    GL_UNPACK_IMAGE_HEIGHT = 0x806E,
    GL_ARRAY_BUFFER = 0x8892,
    GL_ELEMENT_ARRAY_BUFFER = 0x8893,
    GL_PIXEL_UNPACK_BUFFER = 0x88EC,
    GL_PIXEL_UNPACK_BUFFER_BINDING = 0x88EF,
    GL_COPY_WRITE_BUFFER = 0x8F37, /* also asks for its binding */
    GL_STATIC_DRAW = 0x88E4,
    GL_DYNAMIC_COPY = 0x88EA,
    GL_VERTEX_ARRAY_BINDING = 0x85B5,
    GL_CURRENT_PROGRAM = 0x8B8D,
    GL_FRAGMENT_SHADER = 0x8B30,
    GL_VERTEX_SHADER = 0x8B31,
    GL_COMPUTE_SHADER = 0x91B9,
    GL_COMPILE_STATUS = 0x8B81,
    GL_LINK_STATUS = 0x8B82,
    GL_RASTERIZER_DISCARD = 0x8C89,
    GL_INTERLEAVED_ATTRIBS = 0x8C8C,
    GL_TRANSFORM_FEEDBACK_BUFFER = 0x8C8E,
    GL_TRANSFORM_FEEDBACK_BUFFER_BINDING = 0x8C8F,
    GL_TRANSFORM_FEEDBACK_BUFFER_START = 0x8C84,
    GL_TRANSFORM_FEEDBACK_BUFFER_SIZE = 0x8C85,
    GL_SHADER_STORAGE_BUFFER = 0x90D2,
    GL_SHADER_STORAGE_BUFFER_BINDING = 0x90D3,
    GL_SHADER_STORAGE_BUFFER_START = 0x90D4,
    GL_SHADER_STORAGE_BUFFER_SIZE = 0x90D5
};
#define GL_INVALID_INDEX 0xFFFFFFFFu
#define GL_ALL_BARRIER_BITS 0xFFFFFFFFu

#define PLIANT_GL_MAGIC 0x4C475046u          /* of a pliant_gl that was made */
#define PLIANT_GL_MESH_MAGIC 0x4D475046u     /* of a mesh */
#define PLIANT_GL_INSTANCE_MAGIC 0x49475046u /* of an instance */

/* Rows of array textures have 1024 texels: every 3.3 and ES 3.0 has textures of that size. */
#define PLIANT_GL_ROW_SHIFT 10u
#define PLIANT_GL_ROW (1u << PLIANT_GL_ROW_SHIFT)
#define PLIANT_GL_GROUP 64u /* invocations of a work group */

/* Texture units that the library's own programs read from: positions for normals, rows for positions. */
enum { PLIANT_GL_UNIT_SHAPE = 0, PLIANT_GL_UNIT_POSITIONS = 1, PLIANT_GL_UNIT_ROWS = 1, PLIANT_GL_UNIT_COUNT = 2 };
enum { PLIANT_GL_UNPACK_COUNT = 7 }; /* parameters of pixel storage that uploads depend on */

/* What a call of the library changes, as it was before. */
typedef struct pliant_gl_binding {
    gl_int buffer;
    int64_t start, size;
} pliant_gl_binding;

typedef struct pliant_gl_state {
    gl_int program, vertex_array, active_unit, textures[PLIANT_GL_UNIT_COUNT], samplers[PLIANT_GL_UNIT_COUNT];
    gl_int unpack_buffer, unpack[PLIANT_GL_UNPACK_COUNT], copy_buffer, generic;
    pliant_gl_binding indexed[2];
    int discards;
} pliant_gl_state;

/* pliant_gl_state.c: everything that update and the init functions touch. After saving, samplers of the units are 0 and
   pixel storage is that of tightly packed words in memory. */
void pliant_gl_save(const pliant_gl* gl, pliant_gl_state* state);
void pliant_gl_restore(const pliant_gl* gl, const pliant_gl_state* state);

/* pliant_gl_state.c. Clears the caller's earlier errors, so that an error found later is ours (MEMORY). */
void pliant_gl_clear_errors(const pliant_gl* gl);
pliant_gl_result pliant_gl_check_errors(pliant_gl* gl);

/* pliant_gl_shaders.c: compiles both programs for gl->path; the message of a failure goes to gl->message. */
pliant_gl_result pliant_gl_make_programs(pliant_gl* gl);

void pliant_gl_delete_programs(const pliant_gl* gl);

/* Sets what pliant_position() needs in the program in use, its textures being at these units. */
void pliant_gl_set_shape(const pliant_gl_mesh* mesh, const pliant_gl_locations* locations, uint32_t unit, uint32_t row_unit,
                         const float* q, uint32_t columns);

/* pliant_gl.c. Fills the texture of rows of a factored basis. Changes what pliant_gl_save keeps. */
void pliant_gl_update_rows(const pliant_gl_mesh* mesh, const float* q, uint32_t columns);

/* pliant_gl_mesh.c. Fill the position texture or that of rows, which is bound, from the unpack buffer that is bound. */
void pliant_gl_put_positions(const pliant_gl_mesh* mesh);
void pliant_gl_put_rows(const pliant_gl_mesh* mesh);

/* pliant_gl_shaders.c. Puts `text`, and `more` if it is not null, into gl->message, cut to its size. */
void pliant_gl_say(pliant_gl* gl, const char* text, const char* more);

#endif
