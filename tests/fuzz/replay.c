/* Runs the fuzz target on every file named: the corpus as an ordinary test, without libFuzzer. Each file also comes cut in
   half, with each of its first 512 bytes flipped, and mutated MUTATIONS times by its structure, with chunks of the file
   before it: the same bytes in every run. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MUTATIONS 100u
#define LARGEST ((size_t)1 << 17)

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);
size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size, unsigned int seed);
size_t LLVMFuzzerCustomCrossOver(const uint8_t* data1, size_t size1, const uint8_t* data2, size_t size2, uint8_t* out,
                                 size_t max_size, unsigned int seed);

/* Mutations of mutations, four in a row, so that some are far from the file. */
static void mutate(const uint8_t* data, size_t size, const uint8_t* other, size_t other_size)
{
    static uint8_t work[LARGEST];
    size_t made = 0;
    for (unsigned int i = 0; i < MUTATIONS; ++i) {
        if (i % 4 == 0 && i % 16 != 12) {
            memcpy(work, data, size);
            made = size;
        } else if (i % 4 == 0) {
            made = LLVMFuzzerCustomCrossOver(data, size, other, other_size, work, sizeof work, i);
        }
        made = LLVMFuzzerCustomMutator(work, made, sizeof work, i);
        LLVMFuzzerTestOneInput(work, made);
    }
}

static int replay(const char* path)
{
    static uint8_t data[LARGEST], before[LARGEST];
    static size_t before_size = 0;
    FILE* file = fopen(path, "rb");
    if (!file) return 0;
    const size_t size = fread(data, 1, sizeof data, file);
    fclose(file);
    if (size == 0 || size == sizeof data) return 0;
    LLVMFuzzerTestOneInput(data, size);
    LLVMFuzzerTestOneInput(data, size / 2);
    for (size_t at = 0; at < size && at < 512; ++at) {
        data[at] ^= 0xFF;
        LLVMFuzzerTestOneInput(data, size);
        data[at] ^= 0xFF;
    }
    mutate(data, size, before, before_size);
    memcpy(before, data, size);
    before_size = size;
    return 1;
}

int main(int argc, char** argv)
{
    int failed = 0;
    for (int i = 1; i < argc; ++i)
        if (!replay(argv[i])) {
            fprintf(stderr, "cannot read %s\n", argv[i]);
            failed = 1;
        }
    printf("%d inputs replayed, each with %u mutations\n", argc - 1, MUTATIONS);
    return failed || argc < 2;
}
