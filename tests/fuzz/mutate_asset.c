/* Mutates assets by their structure: fields of the header, the table, words inside chunks, sizes and order of chunks, chunks
   of another asset. Then states the new size and checksums, mostly: otherwise nearly every input would stop at R04 or R08.
   A mutator for libFuzzer and, with the generator of replay.c, for the slice that every build runs. */
#include "pliant_format.h"

#include <stdint.h>
#include <string.h>

size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size);
size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size, unsigned int seed);
size_t LLVMFuzzerCustomCrossOver(const uint8_t* data1, size_t size1, const uint8_t* data2, size_t size2, uint8_t* out,
                                 size_t max_size, unsigned int seed);

#define LARGEST ((size_t)1 << 17)

/* An asset taken apart: the bytes of its chunks lie in `source`. */
typedef struct draft {
    pliant_format_header header;
    pliant_format_chunk chunks[PLIANT_FORMAT_MAX_CHUNKS + 1];
    const uint8_t* contents[PLIANT_FORMAT_MAX_CHUNKS + 1];
    uint32_t count;
} draft;

static uint32_t next_random(uint32_t* state)
{
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state;
}

static uint32_t below(uint32_t* state, uint64_t limit) { return (uint32_t)(next_random(state) % limit); }

/* ---------------------------------------------------------------------------------------------------- checksums ---- */

/* CRC-32, eight bytes a step: the repair must not take longer than what it is for. */
static uint32_t crc_of(uint32_t crc, const uint8_t* bytes, size_t size)
{
    static uint32_t tables[8][256];
    if (tables[0][1] == 0) {
        for (uint32_t i = 0; i < 256; ++i) {
            uint32_t value = i;
            for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ (0xEDB88320u & (0u - (value & 1u)));
            tables[0][i] = value;
        }
        for (int t = 1; t < 8; ++t)
            for (uint32_t i = 0; i < 256; ++i) tables[t][i] = (tables[t - 1][i] >> 8) ^ tables[0][tables[t - 1][i] & 0xFFu];
    }
    for (; size >= 8; bytes += 8, size -= 8) {
        uint32_t low, high;
        memcpy(&low, bytes, 4);
        memcpy(&high, bytes + 4, 4);
        low ^= crc;
        crc = tables[7][low & 0xFF] ^ tables[6][low >> 8 & 0xFF] ^ tables[5][low >> 16 & 0xFF] ^ tables[4][low >> 24]
            ^ tables[3][high & 0xFF] ^ tables[2][high >> 8 & 0xFF] ^ tables[1][high >> 16 & 0xFF] ^ tables[0][high >> 24];
    }
    for (; size > 0; --size) crc = (crc >> 8) ^ tables[0][(crc ^ *bytes++) & 0xFFu];
    return crc;
}

/* The table if all of it is there, else null. */
static pliant_format_chunk* table_of(uint8_t* data, size_t size, uint32_t* count)
{
    pliant_format_header header;
    if (size < sizeof header) return NULL;
    memcpy(&header, data, sizeof header);
    *count = header.chunk_count;
    if (header.chunk_count > PLIANT_FORMAT_MAX_CHUNKS) return NULL;
    if (sizeof header + header.chunk_count * sizeof(pliant_format_chunk) > size) return NULL;
    return (pliant_format_chunk*)(void*)(data + sizeof header); /* read and written through memcpy: any address */
}

static void repair(uint8_t* data, size_t size)
{
    pliant_format_header header;
    uint32_t count;
    pliant_format_chunk* table = table_of(data, size, &count);
    if (size < sizeof header) return;
    memcpy(&header, data, sizeof header);
    header.file_size = size;
    header.header_crc32 = 0;
    if (table) {
        for (uint32_t i = 0; i < count; ++i) {
            pliant_format_chunk chunk;
            memcpy(&chunk, (uint8_t*)table + i * sizeof chunk, sizeof chunk);
            if (chunk.offset > size || chunk.size > size - chunk.offset) continue;
            chunk.crc32 = ~crc_of(0xFFFFFFFFu, data + chunk.offset, chunk.size);
            memcpy((uint8_t*)table + i * sizeof chunk, &chunk, sizeof chunk);
        }
        const uint32_t crc = crc_of(0xFFFFFFFFu, (const uint8_t*)&header, sizeof header);
        header.header_crc32 = ~crc_of(crc, (const uint8_t*)table, count * sizeof(pliant_format_chunk));
    }
    memcpy(data, &header, sizeof header);
}

/* -------------------------------------------------------------------------------------------- apart and together ---- */

/* False where the table leads out of the bytes. `source` must stay. */
static int take_apart(draft* d, const uint8_t* source, size_t size)
{
    if (size < sizeof d->header) return 0;
    memcpy(&d->header, source, sizeof d->header);
    d->count = d->header.chunk_count;
    if (d->count > PLIANT_FORMAT_MAX_CHUNKS || sizeof d->header + d->count * sizeof *d->chunks > size) return 0;
    memcpy(d->chunks, source + sizeof d->header, d->count * sizeof *d->chunks);
    for (uint32_t i = 0; i < d->count; ++i) {
        if (d->chunks[i].offset > size || d->chunks[i].size > size - d->chunks[i].offset) return 0;
        d->contents[i] = source + d->chunks[i].offset;
    }
    return d->count > 0;
}

/* In the order of the draft, aligned as the format demands. Chunk i has `available[i]` bytes at `contents[i]`; behind them
   come zeros. 0 if it does not fit. */
static size_t put_together(draft* d, const size_t* available, uint8_t* out, size_t max_size)
{
    d->header.chunk_count = d->count;
    size_t end = sizeof d->header + d->count * sizeof *d->chunks;
    for (uint32_t i = 0; i < d->count; ++i) {
        const size_t alignment = d->chunks[i].tag == PLIANT_CHUNK_BASIS ? 4096 : 64;
        const size_t start = (end + alignment - 1) / alignment * alignment;
        if (start > max_size || d->chunks[i].size > max_size - start) return 0;
        const size_t kept = d->chunks[i].size < available[i] ? d->chunks[i].size : available[i];
        if (start > end) memset(out + end, 0, start - end);
        memcpy(out + start, d->contents[i], kept);
        memset(out + start + kept, 0, d->chunks[i].size - kept);
        d->chunks[i].offset = start;
        end = start + d->chunks[i].size;
    }
    if (sizeof d->header + d->count * sizeof *d->chunks > max_size) return 0;
    memcpy(out, &d->header, sizeof d->header);
    memcpy(out + sizeof d->header, d->chunks, d->count * sizeof *d->chunks);
    return end;
}

static void measure(const draft* d, size_t* available)
{
    for (uint32_t i = 0; i < d->count; ++i) available[i] = d->chunks[i].size;
}

/* ----------------------------------------------------------------------------------------------------- mutations ---- */

/* A number that is special somewhere, or near the one that was there. */
static uint32_t odd_word(uint32_t was, uint32_t* random, const pliant_format_header* header)
{
    static const uint32_t odd[]
        = { 0,          1,          2,          3,          15,         16,         17,         63,
            64,         65,         255,        256,        65535,      65536,      1u << 22,   1u << 26,
            1u << 27,   0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x3F800000, 0xBF800000, 0x7F7FFFFF, 0xFF7FFFFF,
            0x7F800000, 0xFF800000, 0x7FC00000, 0x00000001, 0x00800000, 0x5F000000, 0x20000000, 0x33800000 };
    const uint32_t counts[] = { header->vertex_count, header->triangle_count, header->dimension, header->pose_count };
    switch (below(random, 8)) {
    case 0: return was + 1;
    case 1: return was - 1;
    case 2: return was ^ (1u << below(random, 32));
    case 3: return counts[below(random, 4)] - below(random, 3) + 1;
    case 4: return was * 2;
    case 5: return next_random(random);
    default: return odd[below(random, sizeof odd / sizeof *odd)];
    }
}

static void change_word(uint8_t* at, uint32_t* random, const pliant_format_header* header)
{
    uint32_t word;
    memcpy(&word, at, sizeof word);
    word = odd_word(word, random, header);
    memcpy(at, &word, sizeof word);
}

/* One to four words in a chunk; every second time among its first 64, where counts and kinds stand. */
static void change_words(uint8_t* data, const draft* d, uint32_t* random)
{
    const pliant_format_chunk* chunk = &d->chunks[below(random, d->count)];
    const size_t words = chunk->size / 4;
    if (words == 0) return;
    for (uint32_t left = 1 + below(random, 4); left > 0; --left) {
        const size_t among = below(random, 2) && words > 64 ? 64 : words;
        change_word(data + chunk->offset + 4 * (size_t)below(random, among), random, &d->header);
    }
}

static void change_numbers(uint8_t* data, const draft* d, uint32_t* random)
{
    if (below(random, 3)) /* counts and origin; of the table everything but its checksums */
        change_word(data + 32 + 4 * (size_t)below(random, 8), random, &d->header);
    else
        change_word(data + sizeof d->header + 4 * (size_t)below(random, 8 * (uint64_t)d->count), random, &d->header);
}

/* A chunk grows, shrinks, goes, comes twice, changes place or tag. */
static size_t change_chunks(uint8_t* data, size_t size, size_t max_size, draft* d, uint32_t* random)
{
    static uint8_t source[LARGEST];
    size_t available[PLIANT_FORMAT_MAX_CHUNKS + 1];
    const uint32_t i = below(random, d->count), k = below(random, d->count);
    memcpy(source, data, size);
    if (!take_apart(d, source, size)) return size;
    measure(d, available);
    const pliant_format_chunk moved = d->chunks[i];
    switch (below(random, 6)) {
    case 0: d->chunks[i].size += 4u << below(random, 6); break;
    case 1: d->chunks[i].size -= d->chunks[i].size < 64 ? d->chunks[i].size : 4u << below(random, 5); break;
    case 2:
        d->count -= 1;
        for (uint32_t j = i; j < d->count; ++j) {
            d->chunks[j] = d->chunks[j + 1];
            d->contents[j] = d->contents[j + 1];
            available[j] = available[j + 1];
        }
        break;
    case 3: d->chunks[i].tag = d->chunks[k].tag; break;
    case 4:
        d->chunks[i].size = d->chunks[k].size;
        d->contents[i] = d->contents[k];
        available[i] = available[k];
        break;
    default:
        d->chunks[i] = d->chunks[k];
        d->chunks[k] = moved;
        d->contents[i] = source + d->chunks[i].offset;
        d->contents[k] = source + moved.offset;
        available[i] = d->chunks[i].size;
        available[k] = moved.size;
        break;
    }
    const size_t made = put_together(d, available, data, max_size);
    if (made > 0) return made;
    memcpy(data, source, size);
    return size;
}

size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size, unsigned int seed)
{
    static draft d;
    uint32_t random = seed * 2654435761u | 1u;
    next_random(&random);
    const uint32_t choice = below(&random, 16);
    size_t made = size;
    if (size > LARGEST || choice == 0 || !take_apart(&d, data, size)) {
        made = LLVMFuzzerMutate(data, size, max_size);
    } else if (choice < 4) {
        made = change_chunks(data, size, max_size, &d, &random);
    } else if (choice < 6) {
        change_numbers(data, &d, &random);
    } else if (choice < 9) { /* bytes of one chunk, whose size stays */
        const pliant_format_chunk* chunk = &d.chunks[below(&random, d.count)];
        if (chunk->size > 0) LLVMFuzzerMutate(data + chunk->offset, chunk->size, chunk->size);
    } else {
        change_words(data, &d, &random);
    }
    if (below(&random, 32)) repair(data, made);
    return made;
}

/* The first asset with some chunks of the second, those it has and others; now and then with its counts too. */
size_t LLVMFuzzerCustomCrossOver(const uint8_t* data1, size_t size1, const uint8_t* data2, size_t size2, uint8_t* out,
                                 size_t max_size, unsigned int seed)
{
    static draft d, other;
    size_t available[PLIANT_FORMAT_MAX_CHUNKS + 1];
    uint32_t random = seed * 2654435761u | 1u;
    if (!take_apart(&d, data1, size1) || !take_apart(&other, data2, size2)) return 0;
    measure(&d, available);
    if (below(&random, 4) == 0) memcpy(&d.header.vertex_count, &other.header.vertex_count, 28);
    for (uint32_t left = 1 + below(&random, 4); left > 0; --left) {
        const uint32_t k = below(&random, other.count);
        uint32_t i = 0;
        while (i < d.count && d.chunks[i].tag != other.chunks[k].tag) ++i;
        if (i == d.count) i = d.count < PLIANT_FORMAT_MAX_CHUNKS && below(&random, 2) ? d.count++ : below(&random, d.count);
        d.chunks[i] = other.chunks[k];
        d.contents[i] = other.contents[k];
        available[i] = other.chunks[k].size;
    }
    const size_t made = put_together(&d, available, out, max_size);
    if (made > 0) repair(out, made);
    return made;
}
