/* A preload library for the player: an hour of use without a person or a clock. It takes the place of GLFW's clock (60
   frames a second), of the mouse, the keys and dropped files, and writes what memory is in use. player_memory.py drives it
   by environment variables:

   PLIANT_USE_FRAMES     frames until the window closes
   PLIANT_USE_FILES      files to drop, one after the other, over and over, with ':' between them
   PLIANT_USE_LOG        where a line goes each time the first of them has been open for a while: frame, kilobytes resident,
                         bytes in use by malloc
   PLIANT_USE_DRAW_EVERY the scene is drawn in one frame of so many; the panels always are
   PLIANT_USE_LEAK       bytes to lose in every frame, to see the test fail */
#define _GNU_SOURCE
#include <GLFW/glfw3.h>
#include <dlfcn.h>
#include <malloc.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FRAMES_OF_A_FILE = 300, WARM = 200, PICTURE_EVERY = 6000, RECORD_EVERY = 12000, RECORDED = 5 };

/* libepoxy's pointers, by which the player draws its scene. */
extern void (*epoxy_glDrawElements)(GLenum, GLsizei, GLenum, const void*);
extern void (*epoxy_glDrawArrays)(GLenum, GLint, GLsizei);
extern void (*epoxy_glClear)(GLbitfield);
extern void (*epoxy_glBlitFramebuffer)(GLint, GLint, GLint, GLint, GLint, GLint, GLint, GLint, GLbitfield, GLenum);

static GLFWmousebuttonfun button_changed;
static GLFWscrollfun scrolled;
static GLFWkeyfun key_changed;
static GLFWdropfun dropped;
static long frame;
static uint64_t state = 61;
static int drag_left, held_button, held_key;
static double x, y;

static uint32_t below(uint32_t limit)
{
    state ^= state >> 12;
    state ^= state << 25;
    state ^= state >> 27;
    return (uint32_t)((state * 2685821657736338717ull) >> 32) % limit;
}

static long number(const char* name, long otherwise)
{
    const char* text = getenv(name);
    return text ? strtol(text, NULL, 10) : otherwise;
}

static void* next(const char* name)
{
    void* found = dlsym(RTLD_NEXT, name);
    if (!found) abort();
    return found;
}

/* What the player and ImGui ask for is called from here as well. */
#define CATCH(NAME, TYPE, KEPT)                  \
    TYPE NAME(GLFWwindow* window, TYPE callback) \
    {                                            \
        TYPE (*original)(GLFWwindow*, TYPE);     \
        *(void**)&original = next(#NAME);        \
        KEPT = callback;                         \
        return original(window, callback);       \
    }
CATCH(glfwSetMouseButtonCallback, GLFWmousebuttonfun, button_changed)
CATCH(glfwSetScrollCallback, GLFWscrollfun, scrolled)
CATCH(glfwSetKeyCallback, GLFWkeyfun, key_changed)
CATCH(glfwSetDropCallback, GLFWdropfun, dropped)

void glfwGetCursorPos(GLFWwindow* window, double* at_x, double* at_y)
{
    (void)window;
    *at_x = x;
    *at_y = y;
}

int glfwGetMouseButton(GLFWwindow* window, int button)
{
    (void)window;
    return drag_left > 0 && button == held_button ? GLFW_PRESS : GLFW_RELEASE;
}

/* The window has the focus, though no window manager gives it. */
int glfwGetWindowAttrib(GLFWwindow* window, int attribute)
{
    static int (*original)(GLFWwindow*, int);
    if (!original) *(void**)&original = next("glfwGetWindowAttrib");
    return attribute == GLFW_FOCUSED ? GLFW_TRUE : original(window, attribute);
}

double glfwGetTime(void) { return (double)frame / 60.0; }

int glfwWindowShouldClose(GLFWwindow* window)
{
    (void)window;
    return frame >= number("PLIANT_USE_FRAMES", 0);
}

/* Held until the next frame: ImGui looks at the keys once a frame. */
static void press(GLFWwindow* window, int key)
{
    if (!held_key) key_changed(window, held_key = key, glfwGetKeyScancode(key), GLFW_PRESS, 0);
}

static void release(GLFWwindow* window)
{
    if (held_key) key_changed(window, held_key, glfwGetKeyScancode(held_key), GLFW_RELEASE, 0);
    held_key = 0;
}

static void press_any(GLFWwindow* window)
{
    static const int keys[] = { GLFW_KEY_L, GLFW_KEY_B, GLFW_KEY_E, GLFW_KEY_M, GLFW_KEY_W, GLFW_KEY_H,    GLFW_KEY_S,
                                GLFW_KEY_R, GLFW_KEY_F, GLFW_KEY_0, GLFW_KEY_1, GLFW_KEY_2, GLFW_KEY_SPACE };
    press(window, keys[below(sizeof keys / sizeof *keys)]);
}

static void go_on_dragging(GLFWwindow* window)
{
    x += (double)below(9) - 4.0;
    y += (double)below(9) - 4.0;
    if (--drag_left == 0) button_changed(window, held_button, GLFW_RELEASE, 0);
}

static void use(GLFWwindow* window)
{
    int width, height;
    glfwGetWindowSize(window, &width, &height);
    if (drag_left > 0) {
        go_on_dragging(window);
        return;
    }
    const uint32_t what = below(100);
    if (what < 40) {
        x = below((uint32_t)width);
        y = below((uint32_t)height);
    } else if (what < 80) {
        held_button = below(4) ? GLFW_MOUSE_BUTTON_LEFT : GLFW_MOUSE_BUTTON_MIDDLE;
        button_changed(window, held_button, GLFW_PRESS, 0);
        drag_left = 5 + (int)below(40);
    } else if (what < 85) {
        scrolled(window, 0.0, (double)below(3) - 1.0);
    } else if (what < 90) {
        press_any(window);
    }
}

static void drop_next(GLFWwindow* window)
{
    static long turn;
    static char list[4096];
    snprintf(list, sizeof list, "%s", getenv("PLIANT_USE_FILES"));
    long count = 1;
    for (const char* c = list; *c; ++c) count += *c == ':';
    char* rest = NULL;
    const char* path = strtok_r(list, ":", &rest);
    for (long i = 0; i < turn % count; ++i) path = strtok_r(NULL, ":", &rest);
    dropped(window, 1, &path);
    ++turn;
}

void glfwPollEvents(void)
{
    static void (*original)(void);
    if (!original) *(void**)&original = next("glfwPollEvents");
    original();
    GLFWwindow* window = glfwGetCurrentContext();
    release(window);
    if (frame % FRAMES_OF_A_FILE == 0)
        drop_next(window);
    else if (frame % PICTURE_EVERY == PICTURE_EVERY / 2 + 1)
        press(window, GLFW_KEY_P);
    else if (frame % RECORD_EVERY == 2000 || frame % RECORD_EVERY == 2000 + RECORDED)
        press(window, GLFW_KEY_V);
    else
        use(window);
}

static void write_memory(void)
{
    static FILE* log;
    long pages = 0, resident = 0;
    FILE* file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%ld %ld", &pages, &resident) != 2) abort();
    fclose(file);
    if (!log) log = fopen(getenv("PLIANT_USE_LOG"), "w");
    const struct mallinfo2 used = mallinfo2();
    fprintf(log, "%ld %ld %zu\n", frame, resident * (sysconf(_SC_PAGESIZE) / 1024), used.uordblks + used.hblkhd);
    fflush(log);
}

static void draw_nothing(GLenum mode, GLsizei count, GLenum type, const void* indices)
{
    (void)mode, (void)count, (void)type, (void)indices;
}

static void draw_no_arrays(GLenum mode, GLint first, GLsizei count) { (void)mode, (void)first, (void)count; }

static void clear_nothing(GLbitfield mask) { (void)mask; }

static void blit_nothing(GLint a, GLint b, GLint c, GLint d, GLint e, GLint f, GLint g, GLint h, GLbitfield mask,
                         GLenum filter)
{
    (void)a, (void)b, (void)c, (void)d, (void)e, (void)f, (void)g, (void)h, (void)mask, (void)filter;
}

/* Called from the second frame on, when libepoxy has found the driver's functions. */
#define CHOOSE(NAME, NOTHING)                      \
    do {                                           \
        static __typeof__(epoxy_##NAME) original;  \
        if (!original) original = epoxy_##NAME;    \
        epoxy_##NAME = draws ? original : NOTHING; \
    } while (0)

static void choose_drawing(int draws)
{
    CHOOSE(glDrawElements, draw_nothing);
    CHOOSE(glDrawArrays, draw_no_arrays);
    CHOOSE(glClear, clear_nothing);
    CHOOSE(glBlitFramebuffer, blit_nothing);
}

void glfwSwapBuffers(GLFWwindow* window)
{
    static void (*original)(GLFWwindow*);
    static long turn_frames;
    if (!original) *(void**)&original = next("glfwSwapBuffers");
    original(window);
    if (!turn_frames) {
        turn_frames = FRAMES_OF_A_FILE;
        for (const char* c = getenv("PLIANT_USE_FILES"); *c; ++c) turn_frames += *c == ':' ? FRAMES_OF_A_FILE : 0;
    }
    if (frame % turn_frames == WARM) write_memory();
    if (number("PLIANT_USE_LEAK", 0) > 0 && !malloc((size_t)number("PLIANT_USE_LEAK", 0))) abort();
    ++frame;
    choose_drawing(frame % number("PLIANT_USE_DRAW_EVERY", 1) == 0);
}
