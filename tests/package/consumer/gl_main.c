/* A game without a context: pliant_gl says so. */
#include <pliant_gl.h>
#include <stdio.h>
#include <string.h>

static pliant_gl_function load_nothing(const char* name)
{
    (void)name;
    return NULL;
}

int main(void)
{
    pliant_gl gl;
    const pliant_gl_result result = pliant_gl_init(&gl, load_nothing, NULL);
    printf("%s: %s\n", pliant_gl_result_text(result), gl.message);
    return result == PLIANT_GL_ERROR_CONTEXT && strstr(gl.message, "glGetString") ? 0 : 1;
}
