/* Runs the fuzz target on every file named: the corpus as an ordinary test, without libFuzzer. Each file also comes cut in
   half and with each of its first 512 bytes flipped. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);
size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size);

/* libFuzzer's mutator, which nothing calls here. */
size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size)
{
    (void)data;
    return size < max_size ? size : max_size;
}

static int replay(const char* path)
{
    FILE* file = fopen(path, "rb");
    long size;
    if (!file || fseek(file, 0, SEEK_END) != 0 || (size = ftell(file)) <= 0 || fseek(file, 0, SEEK_SET) != 0) return 0;
    uint8_t* data = malloc((size_t)size);
    if (!data || fread(data, 1, (size_t)size, file) != (size_t)size) return 0;
    fclose(file);
    LLVMFuzzerTestOneInput(data, (size_t)size);
    LLVMFuzzerTestOneInput(data, (size_t)size / 2);
    for (long at = 0; at < size && at < 512; ++at) {
        data[at] ^= 0xFF;
        LLVMFuzzerTestOneInput(data, (size_t)size);
        data[at] ^= 0xFF;
    }
    free(data);
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
    printf("%d inputs replayed\n", argc - 1);
    return failed || argc < 2;
}
