/** @file
   Pliant on the graphics processor: positions and normals into buffers that you draw with your own shaders.

   This header is the manual. A library of its own (pliant::gl) beside the runtime; C99, compiles as C++11; needs no GL headers and
   links to no GL library: you pass the function that your window library loads GL functions with.

   @par What it needs
     OpenGL 3.3 core or later, or OpenGL ES 3.0 or later. With OpenGL 4.3 or ES 3.1 it uses compute shaders, else transform
     feedback. Buffer textures are not used (65,536 texels are all that 3.3 promises): the shape lies in 2D array textures of integers,
     as the file has it, 1024 words wide.
   @par What it does
     pliant_gl_update puts the shape for q into two buffers, once per frame; shadow, depth and colour passes then draw them as any other
     vertex buffers, with pliant_gl_mesh.index_buffer. Or a vertex shader of yours calls pliant_position() itself (the direct
     path): no buffers, no normals, and the work again in every pass; for few dimensions and a single pass.
   @par What it does not do
     Solve (that is pliant_solve, on the processor, microseconds), draw, allocate memory other than GL's, keep globals, create contexts.

   @par Step by step
     Every call with the context current.
     1. pliant_gl_init            once per context: loads functions, compiles shaders.
     2. pliant_gl_mesh_init       once per asset: uploads basis and topology. Asset and adjacency may be dropped afterwards.
     3. pliant_gl_instance_init   once per character: two buffers. All instances of a mesh share what it uploaded.
     4. pliant_gl_update          once per frame and character.
     5. draw: your vertex array, pliant_gl_bind_attributes once, then glDrawElements(GL_TRIANGLES, mesh.index_count, GL_UNSIGNED_INT, 0).
     6. pliant_gl_instance_free, pliant_gl_mesh_free, pliant_gl_free, in this order. Or drop the structs with the context.

   Structs are yours, of fixed size, and must stay where they are while others point to them: an instance points to its mesh, a mesh to
   its pliant_gl. Fields named in comments are for you to read, all others are internal.

   @par GL state
     Every call leaves program, vertex array, active texture unit, textures, samplers, buffer and pixel-store bindings and
     rasterizer discard as they were; pliant_gl_bind_attributes and pliant_gl_direct_bind say what they set. Not restored: GL's error
     flag, which pliant_gl_init, pliant_gl_mesh_init and pliant_gl_instance_init clear. To be as they usually are when you call: no transform feedback active, no
     conditional rendering, no primitive query; for transform feedback a complete framebuffer bound (the library draws
     nothing into it, but GL asks for one).
   @par Synchronisation
     Buffers may be drawn, read back and bound as storage or textures right after pliant_gl_update: it issues the memory barriers.
   @par Threads
     Those of GL: one pliant_gl for each context; contexts that share objects may draw each other's buffers.
   @par Exactness
     Positions equal those of pliant_reconstruct up to rounding (the graphics processor may fuse and reorder), normals those
     of pliant_normals_compute. tests/gl holds them to 1e-4 of the diagonal and 1 degree. */
#ifndef PLIANT_GL_H
#define PLIANT_GL_H

#include "pliant.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What a call answers; numbers never change meaning. */
typedef enum pliant_gl_result {
    PLIANT_GL_OK = 0,
    PLIANT_GL_ERROR_ARGUMENT = 10, /**< a null pointer, an object that was not made, an adjacency of another asset */
    PLIANT_GL_ERROR_CONTEXT
    = 60, /**< no context, one older than 3.3 core or ES 3.0, a function missing, no compute where asked for */
    PLIANT_GL_ERROR_SHADER = 61, /**< the driver refuses a shader: pliant_gl.message has its words */
    PLIANT_GL_ERROR_LIMIT = 62,  /**< the mesh is larger than this context's textures */
    PLIANT_GL_ERROR_MEMORY = 63  /**< the driver is out of memory, or reports another error */
} pliant_gl_result;

/** One English line for a result, never null. */
PLIANT_API const char* pliant_gl_result_text(pliant_gl_result result);

/** A function of GL, whatever its arguments. What gives them: glfwGetProcAddress and eglGetProcAddress as they are, SDL_GL_GetProcAddress with a cast. */
typedef void (*pliant_gl_function)(void);
/** Gives the function of that name, or null. */
typedef pliant_gl_function (*pliant_gl_loader)(const char* name);

/** How positions and normals get into the buffers. */
typedef enum pliant_gl_path {
    PLIANT_GL_PATH_AUTO = 0,     /**< compute where the context has it */
    PLIANT_GL_PATH_FEEDBACK = 1, /**< transform feedback: every context */
    PLIANT_GL_PATH_COMPUTE = 2   /**< OpenGL 4.3, ES 3.1 */
} pliant_gl_path;

/** What to use of a context. Make it with pliant_gl_desc_default, then change what you like. */
typedef struct pliant_gl_desc {
    uint32_t struct_size; /**< set by pliant_gl_desc_default, do not change */
    pliant_gl_path path;  /**< default AUTO */
    uint32_t
        max_texture_size; /**< 0 (default): what the context offers. A power of two from 16 up: use no larger textures */
    uint32_t max_layers;  /**< 0 (default): what the context offers. Else use no more layers of array textures */
} pliant_gl_desc;

/** The defaults named above. */
PLIANT_API pliant_gl_desc pliant_gl_desc_default(void);

#define PLIANT_GL_FUNCTION_COUNT 55 /**< functions of GL that are loaded */
#define PLIANT_GL_MESSAGE_SIZE 1024 /**< bytes of pliant_gl.message */

/** Uniforms of the direct path in a program; -1 where it has none. */
typedef struct pliant_gl_locations {
    /** @cond internal */
    int32_t shape, q, steps, store, compact, columns, origin;
    /** @endcond */
} pliant_gl_locations;

/** What belongs to a context. */
typedef struct pliant_gl {
    pliant_gl_path path; /**< the one chosen, FEEDBACK or COMPUTE */
    uint32_t version;    /**< of the context: major * 10 + minor */
    uint32_t is_es;      /**< 1: OpenGL ES */
    char message
        [PLIANT_GL_MESSAGE_SIZE]; /**< more about the last error, zero-terminated: the driver's words, a missing function */

    /** @cond internal */
    uint32_t magic;
    uint32_t layer_shift; /**< layers of array textures have at most 2^layer_shift rows */
    uint32_t max_layers;
    uint32_t position_program, normal_program, vertex_array;
    pliant_gl_locations locations;
    int32_t position_count, normal_store, normal_points, normal_count; /**< further uniforms */
    pliant_gl_function functions[PLIANT_GL_FUNCTION_COUNT];
    /** @endcond */
} pliant_gl;

/** Loads functions and compiles shaders. On an error *out keeps the message and nothing else; there is nothing to free then. `desc`
   may be null. Cost: two or four shaders, milliseconds. */
PLIANT_API pliant_gl_result pliant_gl_init(pliant_gl* out, pliant_gl_loader load, const pliant_gl_desc* desc);

/** Deletes programs. Null, zeroed or freed: nothing happens. */
PLIANT_API void pliant_gl_free(pliant_gl* gl);

/* ----------------------------------------------------------------------------------------------------------- mesh ---- */

/** An asset on the graphics processor, shared by its instances. */
typedef struct pliant_gl_mesh {
    uint32_t vertex_count; /**< of every buffer: the asset's boundary_vertex_count */
    uint32_t index_count;  /**< 3 for a triangle */
    uint32_t index_buffer; /**< GL buffer of uint32_t */
    uint32_t has_normals;  /**< 1: made with an adjacency */
    uint64_t byte_count;   /**< of GL memory, drivers' padding apart: textures and index buffer */

    /** @cond internal */
    pliant_gl* gl;
    uint32_t dimension;
    uint32_t shape_texture, topology_texture, position_texture;
    /* Of each texture mask and shift of its rows and where its second part starts; where parts of a compact basis are. */
    uint32_t store[3], topology_store[3], position_store[3], compact[4];
    float origin[3];
    float scales[256], steps[256]; /**< what q is multiplied by: for numbers of the basis, for their bases */
    uint32_t magic;
    /** @endcond */
} pliant_gl_mesh;

/** Uploads `asset`. `normals`: its adjacency (pliant_normals_init), or null for positions only. Neither is needed afterwards. On an error
   *out is zeroed. */
PLIANT_API pliant_gl_result pliant_gl_mesh_init(pliant_gl_mesh* out, pliant_gl* gl, const pliant_asset* asset,
                                                const pliant_normals* normals);

/** Deletes its GL objects; its instances must be freed before. Null, zeroed or freed: nothing happens. */
PLIANT_API void pliant_gl_mesh_free(pliant_gl_mesh* mesh);

/* ------------------------------------------------------------------------------------------------------ instances ---- */

/** The shape of one character. */
typedef struct pliant_gl_instance {
    uint32_t
        position_buffer;    /**< GL buffer: vertex_count times three floats, 12 bytes apart, in units of the input meshes */
    uint32_t normal_buffer; /**< the same for normals of length 1; 0 if the mesh has none */

    /** @cond internal */
    const pliant_gl_mesh* mesh;
    uint32_t magic;
    /** @endcond */
} pliant_gl_instance;

/** Makes the buffers; what they hold is undefined before the first update. On an error *out is zeroed. */
PLIANT_API pliant_gl_result pliant_gl_instance_init(pliant_gl_instance* out, const pliant_gl_mesh* mesh);

/** Deletes the buffers. Null, zeroed or freed: nothing happens. */
PLIANT_API void pliant_gl_instance_free(pliant_gl_instance* instance);

/** Rebuilds the buffers for the coordinates `q` (dimension floats, read before the call returns). Costs nothing but commands on the
   caller's side. */
PLIANT_API pliant_gl_result pliant_gl_update(pliant_gl_instance* instance, const float* q);

/** The same from the first `columns` dimensions only, as if the others were zero; more than there are: all. pliant_columns_needed says how
   many a character far away needs. */
PLIANT_API pliant_gl_result pliant_gl_update_columns(pliant_gl_instance* instance, const float* q, uint32_t columns);

/** For the vertex array that is bound: points attribute `position` at the positions, attribute `normal` at the normals (-1: leave that one
   out), enables them, and makes index_buffer the array's element buffer. Sets GL_ARRAY_BUFFER to 0. Once per vertex array. */
PLIANT_API pliant_gl_result pliant_gl_bind_attributes(const pliant_gl_instance* instance, int32_t position, int32_t normal);

/* ---------------------------------------------------------------------------------------------------- direct path ---- */

/** GLSL text (3.30, ES 3.00 and later) that declares

       vec3 pliant_position(int vertex);

   the position of a vertex in units of the input meshes, with gl_VertexID for `vertex` in a vertex shader. Hand it to glShaderSource between your
   `#version` line (in ES with precision statements behind it) and your own text. It takes uniforms of 2 * PLIANT_MAX_DIMENSION floats:
   `#define` that before it as low as your assets allow (default 256), for all names in it start with pliant_ or PLIANT_. */
PLIANT_API const char* pliant_gl_direct_source(void);

/** Looks up the uniforms in a linked program that holds pliant_gl_direct_source. */
PLIANT_API pliant_gl_result pliant_gl_direct_locate(const pliant_gl* gl, uint32_t program, pliant_gl_locations* out);

/** Prepares drawing of `mesh` with coordinates q by the program that is in use: binds its texture to unit `unit` (and no sampler), sets the uniforms
   of `locations` for the first `columns` dimensions. Draw with index_buffer as element buffer and no attributes at all. */
PLIANT_API pliant_gl_result pliant_gl_direct_bind(const pliant_gl_mesh* mesh, const pliant_gl_locations* locations,
                                                  uint32_t unit, const float* q, uint32_t columns);

#ifdef __cplusplus
}
#endif
#endif
