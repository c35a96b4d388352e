/* A preload library that lets the n-th call of a kind fail, or kills the program there, and logs what happens to files.
   run.py sets its environment:

   FAULTS_COUNTS  file of 8-byte numbers, mapped by all processes of a run: calls of each kind, then faults given
   FAULTS_KIND    the kind that is to fail (names below; "change": all that changes files); none: calls are only counted
   FAULTS_AT      the number of the first call that fails, from 1; "alloc" with FAULTS_FORK: of the first fork
   FAULTS_LATER   1: all later calls of the kind fail, too
   FAULTS_ERROR   errno of the failure; or one of the enumeration below
   FAULTS_TRACE   file that gets a line for every change of a file (see trace)
   FAULTS_FORK    K: at every K-th allocation the program forks, and the child alone sees the fault (see fork_fault)
                  whose standard output and error go to the files output and messages above the folder of the run
   FAULTS_CONTROL two descriptors, "READ,WRITE", by which run.py is told of children

   Nothing reaches the disk when a program asks for it (fsync): the runs would take hours. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

/* clang-format off */
enum kind { ALLOC, WRITE, MESSAGE, FSYNC, RENAME, OPEN, READ, MAP, THREAD, UNLINK, STAT, LOCK, MODE, PROCESS, CHANGE, KINDS };
/* clang-format on */
static const char* const kind_names[KINDS] = { "alloc",  "write",  "message", "fsync", "rename", "open",    "read",  "map",
                                               "thread", "unlink", "stat",    "lock",  "mode",   "process", "change" };
enum {
    KILL = 0,  /* instead of the call */
    HALF = -1, /* half of the bytes are written, which is no error */
    HALF_AND_KILL = -2
};

static _Atomic uint64_t* counts; /* KINDS of them, and the faults */
static int wanted_kind = KINDS, is_later, error_number;
static uint64_t first_fault, fork_step;
static int trace_descriptor = -1, control_in = -1, control_out = -1;
static _Atomic int open_output = -1; /* the descriptor of the last file that was created, while it is open */
static _Atomic int has_new_name;     /* a file was renamed */
static __thread int is_inside;       /* a call of this library's own */

/* What of the C library is called. */
#define REAL(X)                                                                          \
    X(write, ssize_t, (int, const void*, size_t))                                        \
    X(fwrite, size_t, (const void*, size_t, size_t, FILE*))                              \
    X(fputs, int, (const char*, FILE*))                                                  \
    X(fflush, int, (FILE*))                                                              \
    X(rename, int, (const char*, const char*))                                           \
    X(open, int, (const char*, int, ...))                                                \
    X(fopen, FILE*, (const char*, const char*))                                          \
    X(opendir, void*, (const char*))                                                     \
    X(read, ssize_t, (int, void*, size_t))                                               \
    X(mmap, void*, (void*, size_t, int, int, int, off_t))                                \
    X(pthread_create, int, (pthread_t*, const pthread_attr_t*, void* (*)(void*), void*)) \
    X(unlink, int, (const char*))                                                        \
    X(stat, int, (const char*, struct stat*))                                            \
    X(lstat, int, (const char*, struct stat*))                                           \
    X(fstat, int, (int, struct stat*))                                                   \
    X(flock, int, (int, int))                                                            \
    X(fchmod, int, (int, mode_t))                                                        \
    X(fork, pid_t, (void))                                                               \
    X(pipe2, int, (int*, int))                                                           \
    X(close, int, (int))                                                                 \
    X(execv, int, (const char*, char* const*))
#define DECLARE(name, type, arguments) static type(*found_##name) arguments;
REAL(DECLARE)

static void look_up(void)
{
#define LOOK_UP(name, type, arguments) *(void**)&found_##name = dlsym(RTLD_NEXT, #name);
    REAL(LOOK_UP)
}

/* Constructors of other libraries come before start(). */
#define real(name) (found_##name ? 0 : (look_up(), 0), found_##name)

extern void* __libc_malloc(size_t);
extern void* __libc_calloc(size_t, size_t);
extern void* __libc_realloc(void*, size_t);
extern void* __libc_memalign(size_t, size_t);

static int number_of(const char* name, int otherwise)
{
    const char* text = getenv(name);
    return text ? atoi(text) : otherwise;
}

static int open_log(const char* name)
{
    const char* path = getenv(name);
    return path ? real(open)(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666) : -1;
}

__attribute__((constructor)) static void start(void)
{
    const char* path = getenv("FAULTS_COUNTS");
    if (!path) return;
    const char* kind = getenv("FAULTS_KIND");
    for (int k = 0; kind && k < KINDS; ++k)
        if (!strcmp(kind, kind_names[k])) wanted_kind = k;
    first_fault = (uint64_t)number_of("FAULTS_AT", 0);
    is_later = number_of("FAULTS_LATER", 0);
    error_number = number_of("FAULTS_ERROR", EIO);
    trace_descriptor = open_log("FAULTS_TRACE");
    fork_step = (uint64_t)number_of("FAULTS_FORK", 0);
    if (fork_step && sscanf(getenv("FAULTS_CONTROL"), "%d,%d", &control_in, &control_out) != 2) abort();
    const int descriptor = real(open)(path, O_RDWR | O_CLOEXEC);
    void* mapped = real(mmap)(NULL, (KINDS + 1) * sizeof *counts, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
    real(close)(descriptor);
    if (mapped != MAP_FAILED) counts = mapped;
}

/* Counts a call; true if it is to fail. */
static int fails(enum kind kind)
{
    if (!counts || is_inside) return 0;
    const uint64_t number = ++counts[kind];
    if ((int)kind != wanted_kind || number < first_fault || (number > first_fault && !is_later)) return 0;
    ++counts[KINDS];
    if (error_number == KILL) kill(getpid(), SIGKILL);
    if (error_number > 0) errno = error_number;
    return 1;
}

/* Of a call that changes a file: also one of all such calls. */
static int change_fails(enum kind kind) { return fails(kind) | fails(CHANGE); }

/* To run.py: the number of an allocation, and what: 0 the program would fork; 1 it cannot; above: the child has ended. */
static void tell(uint64_t number, uint64_t what)
{
    const uint64_t message[2] = { number, what };
    if (real(write)(control_out, message, sizeof message) != sizeof message) abort();
}

static void become_child(void)
{
    static _Atomic uint64_t own[KINDS + 1];
    for (int i = 0; i <= KINDS; ++i) own[i] = counts[i];
    counts = own;
    first_fault = own[ALLOC];
    fork_step = 0;
    alarm(60);
    const int output = real(open)("../output", O_WRONLY | O_CREAT | O_TRUNC | O_APPEND, 0666);
    const int messages = real(open)("../messages", O_WRONLY | O_CREAT | O_TRUNC | O_APPEND, 0666);
    if (dup2(output, STDOUT_FILENO) < 0 || dup2(messages, STDERR_FILENO) < 0) abort();
    real(close)(output);
    real(close)(messages);
}

/* True in the child, which goes on in the same folder: run.py makes it what it was before the parent goes on. Some
   allocations are for a run of their own: a child would share the temporary file that its parent has open, would find the
   outputs that its parent has written, and has one thread only. */
static int fork_fault(void)
{
    const uint64_t number = ++counts[ALLOC];
    if (number < first_fault || (number - first_fault) % fork_step) return 0;
    const int can_fork = open_output < 0 && !has_new_name && syscall(SYS_gettid) == getpid();
    char answer = 0;
    tell(number, !can_fork);
    if (!can_fork || real(read)(control_in, &answer, 1) != 1) return 0;
    is_inside = 1;
    const pid_t child = real(fork)();
    is_inside = 0;
    if (child == 0) {
        become_child();
        return 1;
    }
    int status = 0;
    if (child < 0 || waitpid(child, &status, 0) != child) abort();
    tell(number, 2 + (uint64_t)status);
    if (real(read)(control_in, &answer, 1) != 1) abort(); /* the folder is what it was */
    return 0;
}

static int allocation_fails(void)
{
    if (!(fork_step && counts && !is_inside ? fork_fault() : fails(ALLOC))) return 0;
    errno = ENOMEM;
    return 1;
}

void* malloc(size_t size) { return allocation_fails() ? NULL : __libc_malloc(size); }
void* calloc(size_t count, size_t size) { return allocation_fails() ? NULL : __libc_calloc(count, size); }
void* realloc(void* old, size_t size) { return allocation_fails() ? NULL : __libc_realloc(old, size); }
void* memalign(size_t alignment, size_t size) { return allocation_fails() ? NULL : __libc_memalign(alignment, size); }
void* aligned_alloc(size_t alignment, size_t size) { return memalign(alignment, size); }

int posix_memalign(void** result, size_t alignment, size_t size)
{
    void* memory = memalign(alignment, size);
    if (!memory) return ENOMEM;
    *result = memory;
    return 0;
}

/* The trace: lines of words separated by blanks, bytes in hexadecimal digits. The file is named by device and inode. */
static void trace(const char* format, ...)
{
    if (trace_descriptor < 0 || is_inside) return;
    char line[4096];
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    if (real(write)(trace_descriptor, line, (size_t)length) != length) abort();
}

static unsigned long long file_of(int descriptor)
{
    struct stat status;
    return real(fstat)(descriptor, &status) == 0 ? (unsigned long long)status.st_ino : 0;
}

static int is_regular(int descriptor)
{
    struct stat status;
    return real(fstat)(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

static void trace_write(int descriptor, const unsigned char* bytes, ssize_t count)
{
    if (trace_descriptor < 0 || count <= 0) return;
    is_inside = 1;
    char* text = malloc(2 * (size_t)count + 64);
    int length = snprintf(text, 64, "write %llu ", file_of(descriptor));
    for (ssize_t i = 0; i < count; ++i) length += snprintf(text + length, 3, "%02x", bytes[i]);
    text[length++] = '\n';
    if (real(write)(trace_descriptor, text, (size_t)length) != length) abort();
    free(text);
    is_inside = 0;
}

ssize_t write(int descriptor, const void* bytes, size_t size)
{
    const int is_file = is_regular(descriptor);
    const int has_fault = is_file ? change_fails(WRITE) : fails(MESSAGE);
    if (has_fault && error_number > 0) return -1;
    const ssize_t done = real(write)(descriptor, bytes, has_fault && size > 1 ? size / 2 : size);
    if (has_fault && error_number == HALF_AND_KILL) kill(getpid(), SIGKILL);
    if (is_file) trace_write(descriptor, bytes, done);
    return done;
}

/* Outputs go through write(); streams are messages. A stream remembers its error. */
static int message_fails(FILE* stream)
{
    if (!fails(MESSAGE)) return 0;
    if (stream) stream->_flags |= 0x20; /* _IO_ERR_SEEN, what ferror() asks for */
    return 1;
}

size_t fwrite(const void* bytes, size_t size, size_t count, FILE* stream)
{
    return message_fails(stream) ? 0 : real(fwrite)(bytes, size, count, stream);
}

int fputs(const char* text, FILE* stream) { return message_fails(stream) ? EOF : real(fputs)(text, stream); }
int fflush(FILE* stream) { return message_fails(stream) ? EOF : real(fflush)(stream); }

int fsync(int descriptor)
{
    if (change_fails(FSYNC)) return -1;
    trace("fsync %llu\n", file_of(descriptor));
    return 0;
}

int fdatasync(int descriptor) { return fsync(descriptor); }

int rename(const char* from, const char* to)
{
    if (change_fails(RENAME)) return -1;
    const int result = real(rename)(from, to);
    if (result == 0) {
        has_new_name = 1;
        trace("rename %s %s\n", from, to);
    }
    return result;
}

int open(const char* path, int flags, ...)
{
    va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = flags & O_CREAT ? va_arg(arguments, mode_t) : 0;
    va_end(arguments);
    if (flags & O_CREAT ? change_fails(OPEN) : fails(OPEN)) return -1;
    const int descriptor = real(open)(path, flags, mode);
    if (descriptor < 0 || !(flags & O_CREAT)) return descriptor;
    trace("create %llu %s\n", file_of(descriptor), path);
    open_output = descriptor;
    return descriptor;
}

int close(int descriptor)
{
    if (descriptor == open_output) open_output = -1;
    return real(close)(descriptor);
}

FILE* fopen(const char* path, const char* mode) { return fails(OPEN) ? NULL : real(fopen)(path, mode); }
void* opendir(const char* path) { return fails(OPEN) ? NULL : real(opendir)(path); }
ssize_t read(int descriptor, void* bytes, size_t size) { return fails(READ) ? -1 : real(read)(descriptor, bytes, size); }

void* mmap(void* place, size_t size, int protection, int flags, int descriptor, off_t offset)
{
    return fails(MAP) ? MAP_FAILED : real(mmap)(place, size, protection, flags, descriptor, offset);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*work)(void*), void* argument)
{
    return fails(THREAD) ? error_number : real(pthread_create)(thread, attributes, work, argument);
}

int unlink(const char* path)
{
    if (change_fails(UNLINK)) return -1;
    const int result = real(unlink)(path);
    if (result == 0) trace("unlink %s\n", path);
    return result;
}

int stat(const char* path, struct stat* status) { return fails(STAT) ? -1 : real(stat)(path, status); }
int lstat(const char* path, struct stat* status) { return fails(STAT) ? -1 : real(lstat)(path, status); }
int fstat(int descriptor, struct stat* status) { return fails(STAT) ? -1 : real(fstat)(descriptor, status); }
int flock(int descriptor, int operation) { return fails(LOCK) ? -1 : real(flock)(descriptor, operation); }
int fchmod(int descriptor, mode_t mode) { return change_fails(MODE) ? -1 : real(fchmod)(descriptor, mode); }
pid_t fork(void) { return fails(PROCESS) ? -1 : real(fork)(); }
int pipe2(int ends[2], int flags) { return fails(PROCESS) ? -1 : real(pipe2)(ends, flags); }
int execv(const char* path, char* const arguments[]) { return fails(PROCESS) ? -1 : real(execv)(path, arguments); }
