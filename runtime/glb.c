/* The asset inside a GLB: no JSON is read, the place is fixed by formats/SPEC.md section 7. */
#include "internal.h"

#define GLB_MAGIC 0x46546C67u /* "glTF" */
#define GLB_JSON 0x4E4F534Au
#define GLB_BINARY 0x004E4942u

/* Bytes 0 .. 3 of a little-endian word; the blob may lie anywhere, so no pointer to a word is made. */
static uint32_t word_at(const unsigned char* bytes)
{
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

/* Start of the binary chunk, the second one, and its size; 0 if there is none. */
static pliant_result find_binary(const unsigned char* bytes, size_t size, size_t* start, size_t* length)
{
    if (size < 12 || word_at(bytes) != GLB_MAGIC || word_at(bytes + 4) != 2u) return PLIANT_ERROR_NOT_PLIANT;
    const size_t total = word_at(bytes + 8);
    if (total > size) return PLIANT_ERROR_TRUNCATED;
    if (total < 20 || word_at(bytes + 16) != GLB_JSON) return PLIANT_ERROR_NOT_PLIANT;
    const size_t json = word_at(bytes + 12), rest = total - 20;
    if (json > rest) return PLIANT_ERROR_TRUNCATED;
    if (rest - json < 8) return PLIANT_ERROR_ABSENT;
    const unsigned char* head = bytes + 20 + json;
    if (word_at(head + 4) != GLB_BINARY) return PLIANT_ERROR_ABSENT;
    *start = 20 + json + 8;
    *length = word_at(head);
    return *length > total - *start ? PLIANT_ERROR_TRUNCATED : PLIANT_OK;
}

pliant_result pliant_glb_find(const void* glb, size_t glb_size, size_t* offset, size_t* size)
{
    static const uint8_t identifier[12] = PLIANT_FORMAT_IDENTIFIER;
    pliant_format_header header;
    size_t start = 0, length = 0;
    if (offset) *offset = 0;
    if (size) *size = 0;
    if (!glb || !offset || !size) return PLIANT_ERROR_ARGUMENT;
    const unsigned char* bytes = (const unsigned char*)glb;
    const pliant_result result = find_binary(bytes, glb_size, &start, &length);
    if (result != PLIANT_OK) return result;
    if (length < sizeof header) return PLIANT_ERROR_ABSENT;
    memcpy(&header, bytes + start, sizeof header);
    if (memcmp(header.identifier, identifier, sizeof identifier) != 0) return PLIANT_ERROR_ABSENT;
    if (header.file_size > length) return PLIANT_ERROR_TRUNCATED;
    *offset = start;
    *size = (size_t)header.file_size;
    return PLIANT_OK;
}
