/** @file
   Pliant on the graphics processor: positions and normals in buffers that you draw with your own shaders.

   This header is the manual. pliant::gl is a library of its own beside the runtime. It is C99 and compiles as C++11. It
   needs no GL headers and links to no GL library: you pass the function that your window library loads GL functions with.

   @par What it needs
     OpenGL 3.3 core or later, or OpenGL ES 3.0 or later. With OpenGL 4.3 or ES 3.1 it uses compute shaders, otherwise
     transform feedback. It does not use buffer textures, since OpenGL 3.3 guarantees 65,536 texels only: the shape lies in
     2D array textures of integers, 1024 words wide, in the layout of the file.
   @par What it does
     pliant_gl_update writes the shape for q into two buffers, once per frame. Shadow, depth and colour passes then draw
     them like any other vertex buffers, with pliant_gl_mesh.index_buffer. Alternatively, your own vertex shader calls
     pliant_position() (the direct path). That needs no buffers, but gives no normals and repeats the work in every pass:
     use it for few dimensions and a single pass.
   @par What it does not do
     It does not solve (pliant_solve does, on the processor, in microseconds), draw, allocate memory other than GL objects,
     keep globals or create contexts.

   @par Step by step
     Make every call with the context current.
     1. pliant_gl_init            once per context: loads functions, compiles shaders.
     2. pliant_gl_mesh_init       once per asset: uploads basis and topology; asset and adjacency may be dropped afterwards.
     3. pliant_gl_instance_init   once per character: two buffers. All instances of a mesh share its textures.
     4. pliant_gl_update          once per frame and character.
     5. Draw: your vertex array, pliant_gl_bind_attributes once, then
        glDrawElements(GL_TRIANGLES, mesh.index_count, GL_UNSIGNED_INT, 0).
     6. pliant_gl_instance_free, pliant_gl_mesh_free, pliant_gl_free, in this order; or drop the structs with the context.

   The structs have a fixed size and live in your memory. Do not move a struct while others point to it: an instance points
   to its mesh, a mesh to its pliant_gl. Documented fields are yours to read; the others are internal.

   @par GL state
     Every call restores the program, vertex array, active texture unit, textures, samplers, buffer and pixel-store bindings
     and rasterizer discard. pliant_gl_bind_attributes and pliant_gl_direct_bind document the state that they set. The GL
     error flag is not restored: pliant_gl_init, pliant_gl_mesh_init and pliant_gl_instance_init clear it.
     On entry these must be in their default state: no active transform feedback, no conditional rendering, no primitive
     query. The transform feedback path needs a complete framebuffer to be bound: the library draws nothing into it, but GL
     requires one.
   @par Synchronisation
     After pliant_gl_update the buffers may be drawn, read back, and bound as storage buffers or textures: it issues the
     memory barriers.
   @par Threads
     As in GL: one pliant_gl for each context. Contexts that share objects may draw each other's buffers.
   @par Accuracy
     Positions equal those of pliant_reconstruct, and normals those of pliant_normals_compute, up to rounding: the graphics
     processor may fuse and reorder operations. tests/gl allows 1e-4 of the diagonal and 1 degree. */
#ifndef PLIANT_GL_H
#define PLIANT_GL_H

#include "pliant.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Result of a call; a number never changes its meaning. */
typedef enum pliant_gl_result {
    PLIANT_GL_OK = 0,
    /** A null pointer, an object that was not initialised, or an adjacency of another asset. */
    PLIANT_GL_ERROR_ARGUMENT = 10,
    /** No context, a context older than 3.3 core or ES 3.0, a missing function, or no compute shaders where requested. */
    PLIANT_GL_ERROR_CONTEXT = 60,
    PLIANT_GL_ERROR_SHADER = 61, /**< the driver rejects a shader; pliant_gl.message holds its log */
    PLIANT_GL_ERROR_LIMIT = 62,  /**< the mesh exceeds the texture limits of this context */
    PLIANT_GL_ERROR_MEMORY = 63  /**< the driver is out of memory, or reports another error */
} pliant_gl_result;

/** One line of English text that describes a result: a static string, never null. */
PLIANT_API const char* pliant_gl_result_text(pliant_gl_result result);

/** Generic GL function pointer: cast to the type of the function before a call. */
typedef void (*pliant_gl_function)(void);
/** Returns the GL function of that name, or null. Pass glfwGetProcAddress or eglGetProcAddress directly, and
   SDL_GL_GetProcAddress with a cast. */
typedef pliant_gl_function (*pliant_gl_loader)(const char* name);

/** The method that writes positions and normals into the buffers. */
typedef enum pliant_gl_path {
    PLIANT_GL_PATH_AUTO = 0,     /**< compute shaders if the context has them, otherwise transform feedback */
    PLIANT_GL_PATH_FEEDBACK = 1, /**< transform feedback: works in every context */
    PLIANT_GL_PATH_COMPUTE = 2   /**< compute shaders: OpenGL 4.3, ES 3.1 */
} pliant_gl_path;

/** Settings of a context. Make it with pliant_gl_desc_default, then change what you like. */
typedef struct pliant_gl_desc {
    uint32_t struct_size; /**< set by pliant_gl_desc_default, do not change */
    pliant_gl_path path;  /**< default PLIANT_GL_PATH_AUTO */
    /** Largest height of textures, which are 1024 wide: a power of two, at least 16. 0 (default): the context's limit. */
    uint32_t max_texture_size;
    uint32_t max_layers; /**< largest number of layers of array textures to use; 0 (default): the limit of the context */
} pliant_gl_desc;

/** The defaults named above. */
PLIANT_API pliant_gl_desc pliant_gl_desc_default(void);

#define PLIANT_GL_FUNCTION_COUNT 55 /**< number of GL functions that are loaded */
#define PLIANT_GL_MESSAGE_SIZE 1024 /**< size of pliant_gl.message in bytes */

/** Locations of the direct path's uniforms in a program; -1 where it has none. */
typedef struct pliant_gl_locations {
    /** @cond internal */
    int32_t shape, q, steps, store, compact, columns, origin, rows, rows_store;
    /** @endcond */
} pliant_gl_locations;

/** The objects of one context: functions and programs. */
typedef struct pliant_gl {
    pliant_gl_path path; /**< the method in use, FEEDBACK or COMPUTE */
    uint32_t version;    /**< version of the context: major * 10 + minor */
    uint32_t is_es;      /**< 1 for OpenGL ES, otherwise 0 */
    /** Details of the last error, zero-terminated: the log of the driver, or the name of a missing function. */
    char message[PLIANT_GL_MESSAGE_SIZE];

    /** @cond internal */
    uint32_t magic;
    uint32_t layer_shift; /**< layers of array textures have at most 2^layer_shift rows */
    uint32_t max_layers;
    uint32_t position_program, row_program, normal_program, vertex_array;
    pliant_gl_locations locations, row_locations;
    int32_t position_count, row_count, normal_store, normal_points, normal_count; /**< further uniforms */
    pliant_gl_function functions[PLIANT_GL_FUNCTION_COUNT];
    /** @endcond */
} pliant_gl;

/** Loads functions and compiles shaders. `desc` may be null. On an error *out holds the message only, and there is nothing
   to free. Cost: two or four shaders, milliseconds. */
PLIANT_API pliant_gl_result pliant_gl_init(pliant_gl* out, pliant_gl_loader load, const pliant_gl_desc* desc);

/** Deletes the programs. Does nothing if `gl` is null, zeroed or freed already. */
PLIANT_API void pliant_gl_free(pliant_gl* gl);

/* ----------------------------------------------------------------------------------------------------------- mesh ---- */

/** An asset on the graphics processor, shared by its instances. */
typedef struct pliant_gl_mesh {
    uint32_t vertex_count; /**< number of vertices in every buffer: the asset's boundary_vertex_count */
    uint32_t index_count;  /**< 3 per triangle */
    uint32_t index_buffer; /**< GL buffer of uint32_t */
    uint32_t has_normals;  /**< 1 if made with an adjacency, otherwise 0 */
    uint64_t byte_count;   /**< GL memory of textures and index buffer in bytes, without the driver's padding */

    /** @cond internal */
    pliant_gl* gl;
    uint32_t dimension;
    uint32_t shape_texture, topology_texture, position_texture, row_texture, row_buffer;
    uint32_t row_count; /**< of a factored basis, otherwise 0 */
    /* Of each texture mask and shift of its rows and where its second part starts, of rows where in the shape texture they
       are computed from; where parts of a compact or factored basis are. */
    uint32_t store[3], topology_store[3], position_store[3], rows_store[3], compact[4];
    float origin[3];
    float scales[256], steps[256]; /**< what q is multiplied by: for numbers of the basis, for their bases */
    uint32_t magic;
    /** @endcond */
} pliant_gl_mesh;

/** Uploads `asset`. `normals` is its adjacency (pliant_normals_init), or null for positions only. Both may be dropped
   afterwards. On an error *out is zeroed. */
PLIANT_API pliant_gl_result pliant_gl_mesh_init(pliant_gl_mesh* out, pliant_gl* gl, const pliant_asset* asset,
                                                const pliant_normals* normals);

/** Deletes the GL objects of `mesh`. Free its instances first. Does nothing if `mesh` is null, zeroed or freed already. */
PLIANT_API void pliant_gl_mesh_free(pliant_gl_mesh* mesh);

/* ------------------------------------------------------------------------------------------------------ instances ---- */

/** The buffers with the shape of one character. */
typedef struct pliant_gl_instance {
    /** GL buffer of vertex_count x 3 floats, 12 bytes per vertex, in units of the input meshes. */
    uint32_t position_buffer;
    uint32_t normal_buffer; /**< the same for normals of length 1; 0 if the mesh has none */

    /** @cond internal */
    const pliant_gl_mesh* mesh;
    uint32_t magic;
    /** @endcond */
} pliant_gl_instance;

/** Makes the buffers. Their contents are undefined before the first update. On an error *out is zeroed. */
PLIANT_API pliant_gl_result pliant_gl_instance_init(pliant_gl_instance* out, const pliant_gl_mesh* mesh);

/** Deletes the buffers. Does nothing if `instance` is null, zeroed or freed already. */
PLIANT_API void pliant_gl_instance_free(pliant_gl_instance* instance);

/** Recomputes the buffers for the coordinates `q` (dimension floats, which are read before the call returns). On the calling
   thread it only issues GL commands. */
PLIANT_API pliant_gl_result pliant_gl_update(pliant_gl_instance* instance, const float* q);

/** As pliant_gl_update, from the first `columns` dimensions only, as if the others were zero. If `columns` exceeds the
   dimension, all are used. pliant_columns_needed returns the number that a distant character needs. */
PLIANT_API pliant_gl_result pliant_gl_update_columns(pliant_gl_instance* instance, const float* q, uint32_t columns);

/** Sets up the bound vertex array; call it once per vertex array. Attribute `position` reads the positions, attribute
   `normal` the normals; -1 leaves an attribute out. Enables both attributes, makes index_buffer the element buffer of the
   vertex array, and sets GL_ARRAY_BUFFER to 0. */
PLIANT_API pliant_gl_result pliant_gl_bind_attributes(const pliant_gl_instance* instance, int32_t position, int32_t normal);

/* ---------------------------------------------------------------------------------------------------- direct path ---- */

/** GLSL source (3.30, ES 3.00 and later; a static string) that declares

       vec3 pliant_position(int vertex);

   the position of a vertex in units of the input meshes. In a vertex shader pass gl_VertexID. Hand the source to
   glShaderSource between your `#version` line (in ES also your precision statements) and your own source. Its uniforms take
   2 * PLIANT_MAX_DIMENSION floats: `#define` PLIANT_MAX_DIMENSION before it, as low as your assets allow (default 256). All
   names in it start with pliant_ or PLIANT_. */
PLIANT_API const char* pliant_gl_direct_source(void);

/** Looks up the uniforms in a linked program that contains pliant_gl_direct_source. */
PLIANT_API pliant_gl_result pliant_gl_direct_locate(const pliant_gl* gl, uint32_t program, pliant_gl_locations* out);

/** Prepares the program in use for drawing `mesh` with the coordinates `q`: binds the mesh's textures to the units `unit`
   and, if its basis is factored, `unit` + 1, without samplers, and sets the uniforms of `locations` for the first `columns`
   dimensions. A factored basis takes a pass of its own before, for some 20 numbers per 64 vertices. The mesh keeps them
   until the next call: draw before you prepare the same mesh again. Draw with index_buffer as the element buffer and
   without attributes. */
PLIANT_API pliant_gl_result pliant_gl_direct_bind(const pliant_gl_mesh* mesh, const pliant_gl_locations* locations,
                                                  uint32_t unit, const float* q, uint32_t columns);

#ifdef __cplusplus
}
#endif
#endif
