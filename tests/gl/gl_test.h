/* What the tests of pliant_gl share: contexts without a display, buffers read back, programs of a test's own. */
#ifndef PLIANT_GL_TEST_H
#define PLIANT_GL_TEST_H

#include "../runtime/support.h"
#include "pliant_gl.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

typedef struct test_context {
    EGLDisplay display;
    EGLContext context;
} test_context;

/* The versions that tests ask for. Drivers give the newest that is compatible; Mesa is told to have no newer one. */
typedef struct wished_context {
    const char* name;
    int is_es, major, minor;
    const char *variable, *value, *glsl;
} wished_context;

static const wished_context wished_contexts[] = {
    { "gl33", 0, 3, 3, "MESA_GL_VERSION_OVERRIDE", "3.3", "330" },
    { "gl43", 0, 4, 3, "MESA_GL_VERSION_OVERRIDE", "4.3", "430" },
    { "es30", 1, 3, 0, "MESA_GLES_VERSION_OVERRIDE", "3.0", NULL },
    { "es31", 1, 3, 1, "MESA_GLES_VERSION_OVERRIDE", "3.1", NULL },
};

static inline const wished_context* find_wished(const char* name)
{
    for (size_t i = 0; i < sizeof wished_contexts / sizeof *wished_contexts; ++i)
        if (strcmp(wished_contexts[i].name, name) == 0) return &wished_contexts[i];
    fprintf(stderr, "no context is called %s\n", name);
    exit(2);
}

/* The process ends with 77, "skipped", if there is none to be had. */
static inline void skip_without_context(const char* reason)
{
    printf("skipped: %s (packages libegl1-mesa-dev, libgl1-mesa-dri)\n", reason);
    exit(77);
}

static inline test_context make_context(const wished_context* wished)
{
    test_context made;
    setenv(wished->variable, wished->value, 1);
    if (wished->glsl) setenv("MESA_GLSL_VERSION_OVERRIDE", wished->glsl, 1);
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base")
        || !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
        skip_without_context("this EGL has no platform without a display");
    made.display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    if (made.display == EGL_NO_DISPLAY || !eglInitialize(made.display, NULL, NULL))
        skip_without_context("EGL finds no driver that works without a display");
    const EGLint config_wishes[] = { EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                     wished->is_es ? EGL_OPENGL_ES3_BIT : EGL_OPENGL_BIT, EGL_NONE };
    const EGLint gl_wishes[] = { EGL_CONTEXT_MAJOR_VERSION,
                                 wished->major,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 wished->minor,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_NONE };
    const EGLint es_wishes[]
        = { EGL_CONTEXT_MAJOR_VERSION, wished->major, EGL_CONTEXT_MINOR_VERSION, wished->minor, EGL_NONE };
    EGLConfig config = NULL;
    EGLint count = 0;
    if (!eglBindAPI(wished->is_es ? EGL_OPENGL_ES_API : EGL_OPENGL_API)
        || !eglChooseConfig(made.display, config_wishes, &config, 1, &count) || count == 0)
        skip_without_context("EGL has no configuration for this kind of context");
    made.context = eglCreateContext(made.display, config, EGL_NO_CONTEXT, wished->is_es ? es_wishes : gl_wishes);
    if (made.context == EGL_NO_CONTEXT || !eglMakeCurrent(made.display, EGL_NO_SURFACE, EGL_NO_SURFACE, made.context))
        skip_without_context("the driver refuses this version of GL");
    printf("%s: %s, %s\n", wished->name, (const char*)glGetString(GL_VERSION), (const char*)glGetString(GL_RENDERER));
    return made;
}

/* Of the current context. */
static inline int has_compute_shaders(void) { return epoxy_gl_version() >= (epoxy_is_desktop_gl() ? 43 : 31); }

static inline void drop_context(test_context made)
{
    eglMakeCurrent(made.display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(made.display, made.context);
    eglTerminate(made.display);
}

/* A framebuffer to draw into, bound, with depth. */
typedef struct canvas {
    GLuint framebuffer, colour, depth;
    int width, height;
} canvas;

static inline canvas make_canvas(int width, int height)
{
    canvas c = { 0, 0, 0, width, height };
    glGenFramebuffers(1, &c.framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, c.framebuffer);
    glGenRenderbuffers(1, &c.colour);
    glBindRenderbuffer(GL_RENDERBUFFER, c.colour);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, c.colour);
    glGenRenderbuffers(1, &c.depth);
    glBindRenderbuffer(GL_RENDERBUFFER, c.depth);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, c.depth);
    CHECK(glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE, "framebuffer");
    glViewport(0, 0, width, height);
    return c;
}

/* Three floats for each of `count` vertices, to be freed. */
static inline float* read_buffer(GLuint buffer, size_t count)
{
    float* copy = malloc(12 * count);
    if (!copy) exit(2);
    glBindBuffer(GL_COPY_READ_BUFFER, buffer);
    const void* mapped = glMapBufferRange(GL_COPY_READ_BUFFER, 0, (GLsizeiptr)(12 * count), GL_MAP_READ_BIT);
    CHECK(mapped != NULL, "a buffer cannot be read");
    if (mapped) memcpy(copy, mapped, 12 * count);
    glUnmapBuffer(GL_COPY_READ_BUFFER);
    glBindBuffer(GL_COPY_READ_BUFFER, 0);
    return copy;
}

/* A program of the caller: a version line, in ES the default precision, what comes before main, main. `captured` may be
   null: the name of what transform feedback takes. */
static inline GLuint make_test_program(int is_es, const char* vertex_head, const char* vertex_main, const char* fragment,
                                       const char* captured)
{
    const char* head = is_es ? "#version 300 es\nprecision highp float;\nprecision highp int;\n" : "#version 330 core\n";
    const char* texts[2][3] = { { head, vertex_head, vertex_main }, { head, "", fragment } };
    const GLuint program = glCreateProgram();
    char log[2048] = "";
    GLint linked = 0;
    for (int i = 0; i < 2; ++i) {
        const GLuint shader = glCreateShader(i ? GL_FRAGMENT_SHADER : GL_VERTEX_SHADER);
        glShaderSource(shader, 3, texts[i], NULL);
        glCompileShader(shader);
        glGetShaderInfoLog(shader, sizeof log, NULL, log);
        if (log[0]) fprintf(stderr, "%s", log);
        glAttachShader(program, shader);
        glDeleteShader(shader);
    }
    if (captured) glTransformFeedbackVaryings(program, 1, &captured, GL_INTERLEAVED_ATTRIBS);
    glLinkProgram(program);
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    glGetProgramInfoLog(program, sizeof log, NULL, log);
    CHECK(linked, "a test's program: %s", log);
    return program;
}

/* An adjacency in memory of its own. */
typedef struct made_normals {
    pliant_normals normals;
    void* memory;
} made_normals;

static inline made_normals make_normals(const pliant_asset* asset)
{
    made_normals made;
    const size_t size = pliant_normals_memory(asset);
    made.memory = malloc(size);
    if (!made.memory || pliant_normals_init(&made.normals, asset, made.memory, size) != PLIANT_OK) exit(2);
    return made;
}

#endif
