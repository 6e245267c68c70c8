#include "shim.h"

#include <stddef.h>
#include <string.h>

/* The bindings carry these structs over the border: a gap that only one side knows of would show
 * as wrong windows or colours. */
_Static_assert(sizeof(openexr_shim_window) == 16, "four packed 32-bit corners");
_Static_assert(sizeof(exr_attr_box2i_t) == 16, "a box is two corners");
_Static_assert(offsetof(exr_attr_box2i_t, max) == 8, "a box is two corners");
_Static_assert(sizeof(exr_attr_chromaticities_t) == 32, "four packed points");
_Static_assert(sizeof(exr_result_t) == 4, "result codes are 32-bit");

/* A newer library of the same soname may know fields that these headers do not have yet. */
#define SPARE_BYTES 256

typedef struct {
    exr_encode_pipeline_t pipeline;
    unsigned char spare[SPARE_BYTES];
    /* The library's own routine. */
    exr_result_t (*compress)(exr_encode_pipeline_t *);
} encoder;

typedef struct {
    exr_decode_pipeline_t pipeline;
    unsigned char spare[SPARE_BYTES];
} decoder;

/* The library names files in messages and deletes them when direct writing fails. It has no business
 * with ours, which it sees as a stream: a name below a file can never exist. */
static const char STREAM_NAME[] = "/dev/null/exr";

exr_result_t openexr_shim_start_read(exr_context_t *context, void *user_data,
                                     exr_read_func_ptr_t read, exr_query_size_func_ptr_t size,
                                     exr_error_handler_cb_t on_error) {
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.user_data = user_data;
    init.read_fn = read;
    init.size_fn = size;
    init.error_handler_fn = on_error;
    /* Half a file is an error, not half a picture. */
    init.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    return exr_start_read(context, STREAM_NAME, &init);
}

exr_result_t openexr_shim_start_write(exr_context_t *context, void *user_data,
                                      exr_write_func_ptr_t write,
                                      exr_error_handler_cb_t on_error) {
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.user_data = user_data;
    init.write_fn = write;
    init.error_handler_fn = on_error;
    return exr_start_write(context, STREAM_NAME, EXR_WRITE_FILE_DIRECTLY, &init);
}

static exr_attr_box2i_t to_box(const openexr_shim_window *window) {
    exr_attr_box2i_t box;
    box.min.x = window->left;
    box.min.y = window->top;
    box.max.x = window->right;
    box.max.y = window->bottom;
    return box;
}

static openexr_shim_window from_box(const exr_attr_box2i_t *box) {
    openexr_shim_window window = {box->min.x, box->min.y, box->max.x, box->max.y};
    return window;
}

exr_result_t openexr_shim_set_required(exr_context_t context, const openexr_shim_window *data,
                                       const openexr_shim_window *display,
                                       float pixel_aspect_ratio, exr_compression_t compression) {
    const exr_attr_box2i_t data_box = to_box(data);
    const exr_attr_box2i_t display_box = to_box(display);
    exr_attr_v2f_t centre;
    centre.x = 0.0f;
    centre.y = 0.0f;
    return exr_initialize_required_attr(context, 0, &display_box, &data_box, pixel_aspect_ratio,
                                        &centre, 1.0f, EXR_LINEORDER_INCREASING_Y, compression);
}

exr_result_t openexr_shim_get_windows(exr_const_context_t context, openexr_shim_window *data,
                                      openexr_shim_window *display) {
    exr_attr_box2i_t box;
    exr_result_t result = exr_get_data_window(context, 0, &box);
    if (result != EXR_ERR_SUCCESS) return result;
    *data = from_box(&box);
    result = exr_get_display_window(context, 0, &box);
    if (result != EXR_ERR_SUCCESS) return result;
    *display = from_box(&box);
    return EXR_ERR_SUCCESS;
}

/* Points a channel of a pipeline at its plane; `*found` tells whether there is one. */
static exr_result_t attach(exr_coding_channel_info_t *channel, const openexr_shim_plane *planes,
                           int32_t plane_count, int *found) {
    *found = 0;
    for (int32_t i = 0; i < plane_count; ++i) {
        const openexr_shim_plane *plane = &planes[i];
        if (strcmp(channel->channel_name, plane->name) != 0) continue;
        if (channel->width > plane->width || channel->height > plane->height ||
            channel->data_type != plane->type)
            return EXR_ERR_INVALID_ARGUMENT;
        channel->user_data_type = channel->data_type;
        channel->user_bytes_per_element = channel->bytes_per_element;
        channel->user_pixel_stride = channel->bytes_per_element;
        channel->user_line_stride = plane->width * channel->bytes_per_element;
        channel->decode_to_ptr = (uint8_t *)plane->samples;
        *found = 1;
        return EXR_ERR_SUCCESS;
    }
    return EXR_ERR_SUCCESS;
}

/* Compresses a chunk, or leaves it as it is where that does not make it shorter.
 *
 * Readers take a chunk that is as long as its samples for one that is not compressed. OpenEXR 3.1.5
 * leaves only those alone that would grow: one that comes out even would be read as garbage. */
static exr_result_t compress_if_shorter(exr_encode_pipeline_t *pipeline) {
    const encoder *self = (const encoder *)pipeline;
    const exr_result_t result = self->compress(pipeline);
    if (result == EXR_ERR_SUCCESS && pipeline->compressed_bytes >= pipeline->packed_bytes &&
        pipeline->compressed_buffer != pipeline->packed_buffer) {
        if (pipeline->compressed_alloc_size < pipeline->packed_bytes) return EXR_ERR_OUT_OF_MEMORY;
        memcpy(pipeline->compressed_buffer, pipeline->packed_buffer, pipeline->packed_bytes);
        pipeline->compressed_bytes = pipeline->packed_bytes;
    }
    return result;
}

exr_result_t openexr_shim_encode_scanlines(exr_context_t context, int32_t y,
                                           const openexr_shim_plane *planes, int32_t plane_count) {
    encoder encoder = {EXR_ENCODE_PIPELINE_INITIALIZER, {0}, NULL};
    exr_encode_pipeline_t *pipeline = &encoder.pipeline;
    exr_chunk_info_t chunk;
    memset(&chunk, 0, sizeof chunk);
    exr_result_t result = exr_write_scanline_chunk_info(context, 0, y, &chunk);
    if (result != EXR_ERR_SUCCESS) return result;
    result = exr_encoding_initialize(context, 0, &chunk, pipeline);
    for (int i = 0; result == EXR_ERR_SUCCESS && i < pipeline->channel_count; ++i) {
        int found = 0;
        result = attach(&pipeline->channels[i], planes, plane_count, &found);
        if (result == EXR_ERR_SUCCESS && !found) result = EXR_ERR_INVALID_ARGUMENT;
    }
    if (result == EXR_ERR_SUCCESS)
        result = exr_encoding_choose_default_routines(context, 0, pipeline);
    if (result == EXR_ERR_SUCCESS && pipeline->compress_fn) {
        encoder.compress = pipeline->compress_fn;
        pipeline->compress_fn = compress_if_shorter;
    }
    if (result == EXR_ERR_SUCCESS) result = exr_encoding_run(context, 0, pipeline);
    const exr_result_t closed = exr_encoding_destroy(context, pipeline);
    return result != EXR_ERR_SUCCESS ? result : closed;
}

exr_result_t openexr_shim_decode(exr_const_context_t context, const exr_chunk_info_t *chunk,
                                 const openexr_shim_plane *planes, int32_t plane_count) {
    decoder decoder = {EXR_DECODE_PIPELINE_INITIALIZER, {0}};
    exr_decode_pipeline_t *pipeline = &decoder.pipeline;
    exr_result_t result = exr_decoding_initialize(context, 0, chunk, pipeline);
    for (int i = 0; result == EXR_ERR_SUCCESS && i < pipeline->channel_count; ++i) {
        int found = 0;
        result = attach(&pipeline->channels[i], planes, plane_count, &found);
    }
    if (result == EXR_ERR_SUCCESS)
        result = exr_decoding_choose_default_routines(context, 0, pipeline);
    if (result == EXR_ERR_SUCCESS) result = exr_decoding_run(context, 0, pipeline);
    const exr_result_t closed = exr_decoding_destroy(context, pipeline);
    return result != EXR_ERR_SUCCESS ? result : closed;
}
