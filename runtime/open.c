/* What every file that opens chunks needs: a chunk by its tag, and the count that many chunks start with. */
#include "open.h"

const pliant_format_chunk* pliant_open_search(const pliant_format_chunk* chunks, uint32_t count, uint32_t tag)
{
    for (uint32_t i = 0; i < count; ++i)
        if (chunks[i].tag == tag) return &chunks[i];
    return NULL;
}

const pliant_format_chunk* pliant_open_find(const pliant_open_context* context, uint32_t tag)
{
    return pliant_open_search(context->chunks, context->header.chunk_count, tag);
}

pliant_result pliant_open_count(const pliant_open_context* context, const pliant_format_chunk* chunk, uint32_t limit,
                                uint32_t* count)
{
    pliant_format_count head;
    if (chunk->size < sizeof head) return PLIANT_ERROR_LAYOUT;
    memcpy(&head, context->blob + chunk->offset, sizeof head);
    if (head.count < 1 || head.count > limit) return PLIANT_ERROR_LIMIT;
    if (!pliant_is_zero(head.reserved, sizeof head.reserved)) return PLIANT_ERROR_LAYOUT;
    *count = head.count;
    return PLIANT_OK;
}
