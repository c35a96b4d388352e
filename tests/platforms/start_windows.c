/* Starts main on Windows, with the functions of the C library that test_bits.c calls, from ucrtbase.dll, which is a part of
   Windows. Without this file zig would build MinGW's C library first, which takes a minute of processor time. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char** argv);
int _configure_narrow_argv(int mode);
void __main(void);
void mainCRTStartup(void);

int printf(const char* format, ...)
{
    va_list values;
    va_start(values, format);
    const int count = __stdio_common_vfprintf(0, stdout, format, NULL, values);
    va_end(values);
    return count;
}

int fprintf(FILE* file, const char* format, ...)
{
    va_list values;
    va_start(values, format);
    const int count = __stdio_common_vfprintf(0, file, format, NULL, values);
    va_end(values);
    return count;
}

int snprintf(char* text, size_t size, const char* format, ...)
{
    va_list values;
    va_start(values, format);
    const int count = __stdio_common_vsprintf(2, text, size, format, NULL, values); /* 2: as C99 says */
    va_end(values);
    return count;
}

int fscanf(FILE* file, const char* format, ...)
{
    va_list values;
    va_start(values, format);
    const int count = __stdio_common_vfscanf(0, file, format, NULL, values);
    va_end(values);
    return count;
}

/* Touches the pages of a large stack frame in order, as Windows wants it: rax bytes below the caller's stack pointer. */
__asm__(".globl ___chkstk_ms\n"
        "___chkstk_ms:\n"
        "  pushq %rcx\n"
        "  pushq %rax\n"
        "  leaq 24(%rsp), %rcx\n"
        "1:\n"
        "  cmpq $0x1000, %rax\n"
        "  jb 2f\n"
        "  subq $0x1000, %rcx\n"
        "  orq $0, (%rcx)\n"
        "  subq $0x1000, %rax\n"
        "  jmp 1b\n"
        "2:\n"
        "  subq %rax, %rcx\n"
        "  orq $0, (%rcx)\n"
        "  popq %rax\n"
        "  popq %rcx\n"
        "  ret\n");

void __main(void) {} /* constructors of C++, which there are none of */

void mainCRTStartup(void)
{
    _configure_narrow_argv(1);
    exit(main(*__p___argc(), *__p___argv()));
}
