/* The shaders of pliant_gl. One text serves all contexts: pliant_position() reads the shape texture, what runs it is a
   vertex shader under transform feedback, a compute shader, or the caller's own.

   The shape texture holds words of 32 bits as the file has them, one after the other in rows of 1024: REST, then the basis
   (BASI; or the tiles, fields and data of BASC), each from the start of a row on. Word i is at x = i mod 1024, in row i /
   1024, layers having 2^(shift - 10) rows. Neighbouring vertices read neighbouring words. Of BASF: for every vertex its tile
   and place in it, then tiles, the first row of each, where rows are computed from, eight at a time, and the data. A pass of
   its own multiplies the right factors into the texture of rows, as many as 20 for 64 vertices. */
#include "pliant_gl_internal.h"

/* C99 promises strings of 4095 characters only; every compiler has at least 16,000. */
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Woverlength-strings"
#endif

/* clang-format off */
static const char direct_source[] =
    "#ifndef PLIANT_MAX_DIMENSION\n"
    "#define PLIANT_MAX_DIMENSION 256\n"
    "#endif\n"
    "uniform highp usampler2DArray pliant_shape;\n"
    "uniform highp vec4 pliant_q[(PLIANT_MAX_DIMENSION + 3) / 4];\n"
    "uniform highp vec4 pliant_steps[(PLIANT_MAX_DIMENSION + 3) / 4];\n" /* q times what bases count in */
    "uniform highp uvec3 pliant_store;\n"    /* mask and shift of rows; where the basis starts */
    /* Where fields and data start, the data's end, tiles of REST; 0: single precision. */
    "uniform highp uvec4 pliant_compact;\n"
    "uniform highp uvec2 pliant_columns;\n"  /* used, there */
    "uniform highp vec3 pliant_origin;\n"
    "uniform highp usampler2DArray pliant_rows;\n"
    /* Mask and shift of its rows; where in the other texture they are computed from, 0: the basis is not factored. */
    "uniform highp uvec3 pliant_rows_store;\n"
    "highp ivec3 pliant_texel(highp uint i, highp uvec3 store) {\n"
    "  return ivec3(i & 1023u, (i >> 10) & store.x, i >> store.y);\n"
    "}\n"
    "highp uint pliant_word(highp uint i) { return texelFetch(pliant_shape, pliant_texel(i, pliant_store), 0).r; }\n"
    "highp float pliant_row(highp uint i) {\n"
    "  return uintBitsToFloat(texelFetch(pliant_rows, pliant_texel(i, pliant_rows_store), 0).r);\n"
    "}\n"
    "highp vec3 pliant_three_rows(highp uint i) { return vec3(pliant_row(i), pliant_row(i + 1u), pliant_row(i + 2u)); }\n"
    "highp uvec3 pliant_words(highp uint i) { return uvec3(pliant_word(i), pliant_word(i + 1u), pliant_word(i + 2u)); }\n"
    "highp vec3 pliant_sum_single(highp uint v, highp uint lane) {\n"
    "  highp uint at = pliant_store.z + (v >> 4) * pliant_columns.y * 48u + lane;\n"
    "  highp vec3 sum = vec3(0.0);\n"
    "  for (highp uint j = 0u; j < pliant_columns.x; ++j, at += 48u)\n"
    "    sum += pliant_q[j >> 2][j & 3u] * uintBitsToFloat(pliant_words(at));\n"
    "  return sum;\n"
    "}\n"
    /* the bits of a lane behind its whole words */
    "highp uint pliant_tail(highp uint at, highp uint bits, highp uint lane) {\n"
    "  highp uint tail = 0u, shift = 0u;\n"
    "  if ((bits & 16u) != 0u) {\n"
    "    tail = (pliant_word(at + (lane >> 1)) >> ((lane & 1u) * 16u)) & 65535u;\n"
    "    at += 24u;\n"
    "    shift = 16u;\n"
    "  }\n"
    "  if ((bits & 8u) != 0u) {\n"
    "    tail |= ((pliant_word(at + (lane >> 2)) >> ((lane & 3u) * 8u)) & 255u) << shift;\n"
    "    at += 12u;\n"
    "    shift += 8u;\n"
    "  }\n"
    "  if ((bits & 4u) != 0u) {\n"
    "    highp uint i = lane % 24u;\n"
    "    tail |= ((pliant_word(at + (i >> 2)) >> ((i & 3u) * 8u + lane / 24u * 4u)) & 15u) << shift;\n"
    "  }\n"
    "  return tail;\n"
    "}\n"
    /* Word k of the three lanes of a vertex; lanes: the first and the distance. */
    "highp uvec3 pliant_lanes(highp uint part, highp uint k, highp uint bits, highp uvec2 lanes) {\n"
    "  highp uint at = part + min(k, bits >> 5) * 48u, x = lanes.x, y = x + lanes.y, z = y + lanes.y;\n"
    "  if (k < bits >> 5) return uvec3(pliant_word(at + x), pliant_word(at + y), pliant_word(at + z));\n"
    "  bits &= 31u;\n"
    "  return uvec3(pliant_tail(at, bits, x), pliant_tail(at, bits, y), pliant_tail(at, bits, z));\n"
    "}\n"
    /* A part that is read field by field: where the next one is, and the words loaded last. */
    "struct pliant_reader { highp uint part; highp uint bits; highp uvec2 lanes; highp uint place; highp uint loaded;\n"
    "                       highp uvec3 word; };\n"
    "highp vec3 pliant_field(inout pliant_reader reader, highp uint width) {\n"
    "  if (width == 0u) return vec3(0.0);\n"
    "  highp uint shift = reader.place & 31u, k = reader.place >> 5;\n"
    "  if (k != reader.loaded) reader.word = pliant_lanes(reader.part, k, reader.bits, reader.lanes);\n"
    "  reader.loaded = k;\n"
    "  highp uvec3 number = reader.word >> shift;\n"
    "  if (shift + width > 32u) {\n"
    "    reader.word = pliant_lanes(reader.part, k + 1u, reader.bits, reader.lanes);\n"
    "    reader.loaded = k + 1u;\n"
    "    number |= reader.word << (32u - shift);\n"
    "  }\n"
    "  reader.place += width;\n"
    "  return vec3(number & ((1u << width) - 1u));\n"
    "}\n"
    "highp vec3 pliant_base(highp uint first, highp uint second) {\n"
    "  return vec3(ivec3(int(first << 16), int(first), int(second << 16)) >> 16);\n"
    "}\n"
    "highp vec3 pliant_sum_compact(highp uint v, highp uint lane) {\n"
    "  highp uint tile = v >> 6, tiles = pliant_store.z + 2u * tile, start = pliant_word(tiles);\n"
    "  highp uint parts = min(4u, pliant_compact.w - 4u * tile);\n"
    "  highp uint end = 4u * tile + 4u < pliant_compact.w ? pliant_word(tiles + 2u) : pliant_compact.z;\n"
    "  highp uint size = (end - start) / parts, bits = size / 6u * 4u;\n"
    "  highp uint part = pliant_compact.y + start + ((v >> 4) & 3u) * size;\n"
    "  highp uint field = pliant_compact.x + 2u * tile * pliant_columns.y;\n"
    "  pliant_reader reader = pliant_reader(part, bits, uvec2(lane, 1u), 0u, 0xFFFFFFFFu, uvec3(0u));\n"
    "  highp vec3 sum = vec3(0.0);\n"
    "  for (highp uint j = 0u; j < pliant_columns.x; ++j, field += 2u) {\n"
    "    highp uint first = pliant_word(field), second = pliant_word(field + 1u);\n"
    "    sum += pliant_steps[j >> 2][j & 3u] * pliant_base(first, second);\n"
    "    sum += pliant_q[j >> 2][j & 3u] * pliant_field(reader, second >> 16);\n"
    "  }\n"
    "  return uintBitsToFloat(pliant_word(tiles + 1u)) * sum;\n"
    "}\n"
    "highp vec3 pliant_place_factored(highp uint slot) {\n"
    "  highp uint tile = slot >> 6, at = pliant_store.z + 6u * tile, counts = pliant_word(at + 1u), count = counts >> 16;\n"
    "  highp uint parts = ((counts & 65535u) + 15u) >> 4, lane = (slot >> 4 & 3u) * 48u + (slot & 15u);\n"
    "  highp uint start = pliant_word(at), end = tile + 1u < pliant_compact.w ? pliant_word(at + 6u) : pliant_compact.z;\n"
    "  highp uint data = pliant_compact.y + start + 8u * parts, rows = (count + 19u) & ~7u;\n"
    "  highp float scale = uintBitsToFloat(pliant_word(at + 5u));\n"
    "  if ((pliant_word(at + 5u) & 0x7FFFFFFFu) == 0u)\n" /* as pliant_format_product_is_still() */
    "    return uintBitsToFloat(\n"
    "      uvec3(pliant_word(data + lane), pliant_word(data + lane + 16u), pliant_word(data + lane + 32u)));\n"
    "  highp uint field = data + rows + (rows >> 1) * pliant_columns.y, numbers = field + 2u * count;\n"
    "  highp uint left = numbers + 24u * parts, size = (pliant_compact.y + end - left) / parts;\n"
    "  highp uint half_lane = numbers + (lane >> 1), row = pliant_word(pliant_compact.x + tile);\n"
    "  highp uvec3 pairs = uvec3(pliant_word(half_lane), pliant_word(half_lane + 8u), pliant_word(half_lane + 16u));\n"
    "  highp vec3 x = vec3(pairs >> ((lane & 1u) * 16u) & 65535u);\n"
    "  highp vec3 sum = pliant_three_rows(row) + pliant_three_rows(row + 3u) * x.x + pliant_three_rows(row + 6u) * x.y\n"
    "    + pliant_three_rows(row + 9u) * x.z;\n"
    "  pliant_reader reader = pliant_reader(left + (slot >> 4 & 3u) * size, size / 6u * 4u, uvec2(slot & 15u, 16u), 0u,\n"
    "                                       0xFFFFFFFFu, uvec3(0u));\n"
    "  for (highp uint i = 0u; i < count; ++i, field += 2u) {\n"
    "    highp uint first = pliant_word(field), second = pliant_word(field + 1u);\n"
    "    highp float unit = float(1u << (max(second >> 16, 15u) - 15u));\n"
    "    sum += pliant_row(row + 12u + i) * (pliant_base(first, second) * unit + pliant_field(reader, second >> 16));\n"
    "  }\n"
    "  return uintBitsToFloat(pliant_words(at + 2u)) + scale * x + sum;\n"
    "}\n"
    "highp vec3 pliant_position(int vertex) {\n"
    "  highp uint v = uint(vertex), lane = 3u * (v & 15u);\n"
    "  if (pliant_rows_store.z != 0u) return pliant_place_factored(pliant_word(v)) + pliant_origin;\n"
    "  highp vec3 rest = uintBitsToFloat(pliant_words((v >> 4) * 48u + lane));\n"
    "  if (pliant_compact.w != 0u) return rest + pliant_sum_compact(v, lane) + pliant_origin;\n"
    "  return rest + pliant_sum_single(v, lane) + pliant_origin;\n"
    "}\n";

static const char feedback_position[] =
    "out highp vec3 pliant_out;\n"
    "void main() {\n"
    "  pliant_out = pliant_position(gl_VertexID);\n"
    "  gl_Position = vec4(0.0);\n"
    "}\n";

/* Of ES a program needs one; nothing is rasterised. */
static const char empty_fragment[] = "void main() {}\n";

static const char compute_head[] =
    "layout(local_size_x = 64) in;\n"
    "uniform highp uint pliant_count;\n"
    "highp uint pliant_invocation() {\n"
    "  return gl_GlobalInvocationID.y * gl_NumWorkGroups.x * 64u + gl_GlobalInvocationID.x;\n"
    "}\n";

static const char compute_position[] =
    "layout(std430, binding = 0) writeonly buffer pliant_positions { highp float pliant_place[]; };\n"
    "void main() {\n"
    "  highp uint v = pliant_invocation();\n"
    "  if (v >= pliant_count) return;\n"
    "  highp vec3 place = pliant_position(int(v));\n"
    "  for (int c = 0; c < 3; ++c) pliant_place[3u * v + uint(c)] = place[c];\n"
    "}\n";

/* Row `index` of the right factors' products with q. For every eight of them: where their scales are, where the first column
   of their numbers is, and the distance of columns. */
static const char row_source[] =
    "highp float pliant_product(highp uint index) {\n"
    "  highp uint group = pliant_rows_store.z + 3u * (index >> 3), i = index & 7u;\n"
    "  highp uint at = pliant_word(group + 1u) + (i >> 1), stride = pliant_word(group + 2u), shift = 16u - (i & 1u) * 16u;\n"
    "  highp float sum = 0.0;\n"
    "  for (highp uint j = 0u; j < pliant_columns.x; ++j, at += stride)\n"
    "    sum += pliant_q[j >> 2][j & 3u] * float(int(pliant_word(at) << shift) >> 16);\n"
    "  return uintBitsToFloat(pliant_word(pliant_word(group) + i)) * sum;\n"
    "}\n";

static const char feedback_row[] =
    "out highp float pliant_out;\n"
    "void main() {\n"
    "  pliant_out = pliant_product(uint(gl_VertexID));\n"
    "  gl_Position = vec4(0.0);\n"
    "}\n";

static const char compute_row[] =
    "layout(std430, binding = 0) writeonly buffer pliant_products { highp float pliant_result[]; };\n"
    "void main() {\n"
    "  highp uint i = pliant_invocation();\n"
    "  if (i < pliant_count) pliant_result[i] = pliant_product(i);\n"
    "}\n";

/* Topology: for every vertex the start and the count of its words, then the neighbours (pliant.h). */
static const char normal_source[] =
    "uniform highp usampler2DArray pliant_topology;\n"
    "uniform highp uvec3 pliant_store;\n"
    "highp ivec3 pliant_texel(highp uint i, highp uvec3 store) {\n"
    "  return ivec3(i & 1023u, (i >> 10) & store.x, i >> store.y);\n"
    "}\n"
    "highp uint pliant_word(highp uint i) { return texelFetch(pliant_topology, pliant_texel(i, pliant_store), 0).r; }\n"
    "highp vec3 pliant_point(highp uint v);\n"
    "highp vec3 pliant_normal(highp uint v) {\n"
    "  highp uint at = pliant_store.z + pliant_word(2u * v), end = at + pliant_word(2u * v + 1u);\n"
    "  highp vec3 centre = pliant_point(v), sum = vec3(0.0), a = vec3(0.0);\n"
    "  for (; at < end; ++at) {\n"
    "    highp uint word = pliant_word(at);\n"
    "    highp vec3 b = pliant_point(word & 0x7FFFFFFFu) - centre;\n"
    "    if ((word >> 31) == 0u) sum += cross(a, b);\n"
    "    a = b;\n"
    "  }\n"
    "  highp float largest = max(abs(sum.x), max(abs(sum.y), abs(sum.z)));\n"
    "  sum /= largest;\n"
    "  highp float squared = dot(sum, sum);\n"
    "  return squared >= 0.5 && squared < 4.0 ? sum * inversesqrt(squared) : vec3(0.0, 0.0, 1.0);\n"
    "}\n";

static const char feedback_normal[] =
    "uniform highp sampler2DArray pliant_points;\n"
    "uniform highp uvec3 pliant_points_store;\n"
    "out highp vec3 pliant_out;\n"
    "highp vec3 pliant_point(highp uint v) {\n"
    "  return texelFetch(pliant_points, pliant_texel(v, pliant_points_store), 0).xyz;\n"
    "}\n"
    "void main() {\n"
    "  pliant_out = pliant_normal(uint(gl_VertexID));\n"
    "  gl_Position = vec4(0.0);\n"
    "}\n";

static const char compute_normal[] =
    "layout(std430, binding = 0) readonly buffer pliant_positions { highp float pliant_place[]; };\n"
    "layout(std430, binding = 1) writeonly buffer pliant_normals { highp float pliant_direction[]; };\n"
    "highp vec3 pliant_point(highp uint v) {\n"
    "  return vec3(pliant_place[3u * v], pliant_place[3u * v + 1u], pliant_place[3u * v + 2u]);\n"
    "}\n"
    "void main() {\n"
    "  highp uint v = pliant_invocation();\n"
    "  if (v >= pliant_count) return;\n"
    "  highp vec3 direction = pliant_normal(v);\n"
    "  for (int c = 0; c < 3; ++c) pliant_direction[3u * v + uint(c)] = direction[c];\n"
    "}\n";

static const char es_precision[] = "precision highp float;\nprecision highp int;\n";
/* clang-format on */

const char* pliant_gl_direct_source(void) { return direct_source; }

/* -------------------------------------------------------------------------------------------------------- programs ---- */

void pliant_gl_say(pliant_gl* gl, const char* text, const char* more)
{
    size_t at = 0;
    for (; *text && at + 1 < sizeof gl->message; ++text) gl->message[at++] = *text;
    for (; more && *more && at + 1 < sizeof gl->message; ++more) gl->message[at++] = *more;
    gl->message[at] = 0;
}

static const char* version_line(const pliant_gl* gl)
{
    if (gl->path == PLIANT_GL_PATH_COMPUTE) return gl->is_es ? "#version 310 es\n" : "#version 430 core\n";
    return gl->is_es ? "#version 300 es\n" : "#version 330 core\n";
}

/* A compiled shader of four texts, or 0. */
static gl_name compile(pliant_gl* gl, gl_enum kind, const char* first, const char* second, const char* third,
                       const char* fourth)
{
    const char* texts[6] = { version_line(gl), gl->is_es ? es_precision : "", first, second, third, fourth };
    gl_int good = 0;
    const gl_name shader = GL(gl, CreateShader)(kind);
    GL(gl, ShaderSource)(shader, 6, texts, NULL);
    GL(gl, CompileShader)(shader);
    GL(gl, GetShaderiv)(shader, GL_COMPILE_STATUS, &good);
    if (good) return shader;
    GL(gl, GetShaderInfoLog)(shader, PLIANT_GL_MESSAGE_SIZE, NULL, gl->message);
    GL(gl, DeleteShader)(shader);
    return 0;
}

/* Links shaders (the second may be 0) and lets go of them. 0 if that fails. */
static gl_name link(pliant_gl* gl, gl_name first, gl_name second, int captures)
{
    static const char* const varyings[1] = { "pliant_out" };
    gl_int good = 0;
    const gl_name program = GL(gl, CreateProgram)();
    GL(gl, AttachShader)(program, first);
    if (second) GL(gl, AttachShader)(program, second);
    if (captures) GL(gl, TransformFeedbackVaryings)(program, 1, varyings, GL_INTERLEAVED_ATTRIBS);
    GL(gl, LinkProgram)(program);
    GL(gl, GetProgramiv)(program, GL_LINK_STATUS, &good);
    if (good) return program;
    GL(gl, GetProgramInfoLog)(program, PLIANT_GL_MESSAGE_SIZE, NULL, gl->message);
    GL(gl, DeleteProgram)(program);
    return 0;
}

/* A program for the path of `gl` out of `body`, what it calls and what runs it. 0 if the driver refuses it. */
static gl_name make_program(pliant_gl* gl, const char* library, const char* body, const char* feedback_main,
                            const char* compute_main)
{
    const int computes = gl->path == PLIANT_GL_PATH_COMPUTE;
    gl_name program = 0;
    const gl_name first = computes ? compile(gl, GL_COMPUTE_SHADER, compute_head, library, body, compute_main)
                                   : compile(gl, GL_VERTEX_SHADER, library, body, feedback_main, "");
    const gl_name second = first && !computes ? compile(gl, GL_FRAGMENT_SHADER, empty_fragment, "", "", "") : 0;
    if (first && (computes || second)) program = link(gl, first, second, !computes);
    if (first) GL(gl, DeleteShader)(first);
    if (second) GL(gl, DeleteShader)(second);
    return program;
}

static void locate(const pliant_gl* gl, gl_name program, pliant_gl_locations* out)
{
    out->shape = GL(gl, GetUniformLocation)(program, "pliant_shape");
    out->q = GL(gl, GetUniformLocation)(program, "pliant_q");
    out->steps = GL(gl, GetUniformLocation)(program, "pliant_steps");
    out->store = GL(gl, GetUniformLocation)(program, "pliant_store");
    out->compact = GL(gl, GetUniformLocation)(program, "pliant_compact");
    out->columns = GL(gl, GetUniformLocation)(program, "pliant_columns");
    out->origin = GL(gl, GetUniformLocation)(program, "pliant_origin");
    out->rows = GL(gl, GetUniformLocation)(program, "pliant_rows");
    out->rows_store = GL(gl, GetUniformLocation)(program, "pliant_rows_store");
}

void pliant_gl_delete_programs(const pliant_gl* gl)
{
    GL(gl, DeleteProgram)(gl->position_program); /* zeros are skipped */
    GL(gl, DeleteProgram)(gl->row_program);
    GL(gl, DeleteProgram)(gl->normal_program);
}

pliant_gl_result pliant_gl_make_programs(pliant_gl* gl)
{
    gl->position_program = make_program(gl, direct_source, "", feedback_position, compute_position);
    if (gl->position_program) gl->row_program = make_program(gl, direct_source, row_source, feedback_row, compute_row);
    if (gl->row_program) gl->normal_program = make_program(gl, normal_source, "", feedback_normal, compute_normal);
    if (!gl->normal_program) {
        pliant_gl_delete_programs(gl);
        gl->position_program = gl->row_program = 0;
        return PLIANT_GL_ERROR_SHADER;
    }
    locate(gl, gl->row_program, &gl->row_locations);
    gl->row_count = GL(gl, GetUniformLocation)(gl->row_program, "pliant_count");
    locate(gl, gl->position_program, &gl->locations);
    gl->position_count = GL(gl, GetUniformLocation)(gl->position_program, "pliant_count");
    gl->normal_count = GL(gl, GetUniformLocation)(gl->normal_program, "pliant_count");
    gl->normal_store = GL(gl, GetUniformLocation)(gl->normal_program, "pliant_store");
    gl->normal_points = GL(gl, GetUniformLocation)(gl->normal_program, "pliant_points_store");
    GL(gl, UseProgram)(gl->normal_program);
    GL(gl, Uniform1i)(GL(gl, GetUniformLocation)(gl->normal_program, "pliant_topology"), PLIANT_GL_UNIT_SHAPE);
    GL(gl, Uniform1i)(GL(gl, GetUniformLocation)(gl->normal_program, "pliant_points"), PLIANT_GL_UNIT_POSITIONS);
    return PLIANT_GL_OK;
}

/* -------------------------------------------------------------------------------------------------------- uniforms ---- */

void pliant_gl_set_shape(const pliant_gl_mesh* mesh, const pliant_gl_locations* locations, uint32_t unit, uint32_t row_unit,
                         const float* q, uint32_t columns)
{
    const pliant_gl* gl = mesh->gl;
    const gl_int vectors = (gl_int)((mesh->dimension + 3) / 4);
    float scaled[PLIANT_FORMAT_MAX_DIMENSION] = { 0 };
    for (uint32_t j = 0; j < mesh->dimension; ++j) scaled[j] = q[j] * mesh->scales[j];
    GL(gl, Uniform1i)(locations->shape, (gl_int)unit);
    GL(gl, Uniform1i)(locations->rows, (gl_int)row_unit);
    GL(gl, Uniform3uiv)(locations->rows_store, 1, mesh->rows_store);
    GL(gl, Uniform4fv)(locations->q, vectors, scaled);
    if (mesh->compact[3] && !mesh->row_count) {
        for (uint32_t j = 0; j < mesh->dimension; ++j) scaled[j] *= mesh->steps[j];
        GL(gl, Uniform4fv)(locations->steps, vectors, scaled);
    }
    GL(gl, Uniform3uiv)(locations->store, 1, mesh->store);
    GL(gl, Uniform4uiv)(locations->compact, 1, mesh->compact);
    GL(gl, Uniform2ui)(locations->columns, columns < mesh->dimension ? columns : mesh->dimension, mesh->dimension);
    GL(gl, Uniform3fv)(locations->origin, 1, mesh->origin);
}

pliant_gl_result pliant_gl_direct_locate(const pliant_gl* gl, uint32_t program, pliant_gl_locations* out)
{
    if (!gl || gl->magic != PLIANT_GL_MAGIC || program == 0 || !out) return PLIANT_GL_ERROR_ARGUMENT;
    locate(gl, program, out);
    return PLIANT_GL_OK;
}
